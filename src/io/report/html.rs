//! The report as one HTML page that needs nothing beside itself.

use super::{Block, Figure, Image, Page, Picture, Section, Table};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use std::fmt::Write as _;

/// The page as the text of an HTML file: style, pictures and charts inside.
pub fn html(page: &Page) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <header>\n<h1>{title}</h1>\n<p>{subtitle}</p>\n</header>\n\
         {warnings}{figures}{sections}</main>\n</body>\n</html>\n",
        title = escape(&page.title),
        subtitle = escape(&page.subtitle),
        warnings = warnings(&page.warnings),
        figures = figures(&page.figures),
        sections = joined(&page.sections, section),
    )
}

/// The text with the characters that mean something in HTML and XML made harmless, and without the
/// control characters that XML forbids.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\n' | '\t' => safe.push(c),
            c if c.is_control() => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

fn warnings(warnings: &[String]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let items = joined(warnings, |w| {
        format!(
            "<li>{}</li>
",
            escape(w)
        )
    });
    let heading = if warnings.len() == 1 { "One warning" } else { "Warnings" };
    format!("<aside role=\"alert\">\n<h2>{heading}</h2>\n<ul>\n{items}</ul>\n</aside>\n")
}

fn figures(figures: &[Figure]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let card = |figure: &Figure| {
        format!(
            "<div><dt>{}</dt><dd>{} <small>{}</small></dd></div>\n",
            escape(&figure.label),
            escape(&figure.value),
            escape(&figure.unit)
        )
    };
    format!("<dl class=\"figures\">\n{}</dl>\n", joined(figures, card))
}

fn section(section: &Section) -> String {
    let mut text = format!("<section>\n<h2>{}</h2>\n", escape(&section.title));
    for block in &section.blocks {
        match block {
            Block::Text(paragraph) => {
                let _ = writeln!(text, "<p>{}</p>", escape(paragraph));
            }
            Block::Facts(facts) => text.push_str(&self::facts(facts)),
            Block::Table(table) => text.push_str(&self::table(table)),
            Block::Pictures(pictures) => {
                let pictures = joined(pictures, picture);
                let _ = write!(text, "<div class=\"pictures\">\n{pictures}</div>\n");
            }
        }
    }
    text + "</section>\n"
}

fn facts(facts: &[(String, String)]) -> String {
    let row = |(key, value): &(String, String)| {
        format!("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape(key), escape(value))
    };
    let rows = joined(facts, row);
    format!("<div class=\"table\"><table class=\"facts\">\n{rows}</table></div>\n")
}

fn table(table: &Table) -> String {
    let cells =
        |row: &[String], tag: &str| joined(row, |cell| format!("<{tag}>{}</{tag}>", escape(cell)));
    let head = cells(&table.columns, "th");
    let row = |row: &Vec<String>| format!("<tr>{}</tr>\n", cells(row, "td"));
    let body = joined(&table.rows, row);
    format!(
        "<div class=\"table\"><table>\n<thead><tr>{head}</tr></thead>\n\
         <tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

fn picture(picture: &Picture) -> String {
    let title = escape(&picture.title);
    let image = match &picture.image {
        Image::Png(bytes) => {
            format!("<img alt=\"{title}\" src=\"data:image/png;base64,{}\">", BASE64.encode(bytes))
        }
        Image::Svg(text) => text.clone(),
    };
    let caption = escape(&picture.caption);
    format!("<figure>\n{image}\n<figcaption><b>{title}</b> {caption}</figcaption>\n</figure>\n")
}

/// The texts of all `items`, one after the other.
fn joined<T>(items: &[T], text: impl Fn(&T) -> String) -> String {
    items.iter().map(text).collect::<Vec<_>>().concat()
}

const STYLE: &str = include_str!("report.css");

#[cfg(test)]
pub(super) mod tests {
    use super::super::png::tests::decode_png;
    use super::super::{Labels, Raster, Series, encode_png, line_chart};
    use super::*;

    /// Every tag that opens is closed, in order, and nothing else looks like a tag.
    pub(in crate::io::report) fn assert_balanced(text: &str) {
        let mut open = Vec::new();
        for piece in text.split('<').skip(1) {
            let (tag, _) = piece.split_once('>').unwrap_or_else(|| panic!("unended <{piece}"));
            let name = tag.split([' ', '\n', '/']).next().unwrap_or_default();
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(name), "</{name}> closes nothing that is open");
            } else if !tag.ends_with('/') && !["!doctype", "meta", "img"].contains(&name) {
                open.push(name);
            }
        }
        assert!(open.is_empty(), "left open: {open:?}");
    }

    fn nasty_page() -> Page {
        let nasty = || "<script>alert(\"1\" & '2')</script>\u{7}".to_owned();
        let raster = Raster { width: 2, height: 1, pixels: vec![[1, 2, 3], [4, 5, 6]] };
        let chart = line_chart(
            &[Series { name: nasty(), points: vec![[0.0, 1.0], [1.0, 2.0]] }],
            Labels { x: "<x>", y: "<y>" },
        );
        let picture = |image| Picture { title: nasty(), caption: nasty(), image };
        Page {
            title: nasty(),
            subtitle: nasty(),
            warnings: vec![nasty()],
            figures: vec![Figure { label: nasty(), value: nasty(), unit: nasty() }],
            sections: vec![Section {
                title: nasty(),
                blocks: vec![
                    Block::Text(nasty()),
                    Block::Facts(vec![(nasty(), nasty())]),
                    Block::Table(Table { columns: vec![nasty()], rows: vec![vec![nasty()]] }),
                    Block::Pictures(vec![
                        picture(Image::Png(encode_png(&raster).unwrap())),
                        picture(Image::Svg(chart)),
                    ]),
                ],
            }],
        }
    }

    #[test]
    fn page_escapes_whatever_it_is_given() {
        let text = html(&nasty_page());
        assert!(!text.contains("<script") && !text.contains('\u{7}'));
        // Title twice, 13 other places: the alt text of a picture repeats its title.
        let n_times = text.matches("&lt;script&gt;alert(&quot;1&quot; &amp; &#39;2&#39;)").count();
        assert_eq!(n_times, 19);
        assert_balanced(&text);
    }

    #[test]
    fn page_needs_nothing_from_outside() {
        let text = html(&nasty_page());
        for way_out in ["http:", "https:", "//", "@import", "url(", "<link", "<iframe"] {
            let found = text.find(way_out).map(|i| &text[i..(i + 40).min(text.len())]);
            // Base64 may hold two slashes of its own; only outside of data does it count.
            let outside = text.split('"').filter(|part| !part.starts_with("data:"));
            assert!(!outside.into_iter().any(|part| part.contains(way_out)), "{found:?}");
        }
    }

    #[test]
    fn pictures_in_the_page_decode_to_the_pixels_they_were_made_from() {
        let text = html(&nasty_page());
        let (_, rest) = text.split_once("<img").unwrap();
        let (_, data) = rest.split_once("base64,").unwrap();
        let bytes = BASE64.decode(data.split('"').next().unwrap()).unwrap();
        assert_eq!(decode_png(&bytes).pixels, [[1, 2, 3], [4, 5, 6]]);
    }

    #[test]
    fn empty_page_has_no_empty_boxes() {
        let text = html(&Page::default());
        assert_balanced(&text);
        assert!(!text.contains("<aside") && !text.contains("<dl"));
    }
}

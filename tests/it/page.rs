//! The page and the summary of a cam job, of real jobs on small parts.

use crate::parts::real;
use horma::cam::{Block, Strategy};
use horma::gcode::{Dialect, Violation, ViolationKind};
use horma::geom::shapes::{self, LastParameters, last};
use horma::geom::{Aabb, Point3, Surface};
use horma::io::read_surface;
use horma::io::report::{Block as Shown, Image, Page, Picture, cam_page, cam_summary, html};
use horma::machine::Machine;
use horma::progress::Silent;
use horma::tool::Tool;
use horma::workflow::cam::{CamOptions, Job, Plan, plan, rough};

/// A coarse run over `surface` on the embedded machine.
fn cut(surface: Surface, machine: &str, tool: &str, options: &CamOptions) -> Plan {
    let machine = Machine::builtin(machine).unwrap();
    let job = Job {
        name: "left <last>.stl".into(),
        surface,
        notes: vec!["read in mm & by extent".into()],
        dialect: &Dialect::named(&machine.dialect).unwrap(),
        machine: &machine,
        tool: Tool::from_shorthand(tool).unwrap(),
        options,
        keep_scene: true,
    };
    plan(job, &Silent).unwrap()
}

fn coarse() -> CamOptions {
    CamOptions { pitch: Some(4.0), points_per_turn: Some(90), ..CamOptions::default() }
}

fn small_last() -> Surface {
    Surface::Mesh(last(&LastParameters { resolution: Some(5.0), ..Default::default() }).unwrap())
}

fn turned_last() -> Plan {
    cut(small_last(), "last-lathe", "wheel:60,10", &coarse())
}

fn pictures(page: &Page) -> Vec<&Picture> {
    let blocks = page.sections.iter().flat_map(|section| &section.blocks);
    let pictures = blocks.filter_map(|block| match block {
        Shown::Pictures(pictures) => Some(pictures),
        _ => None,
    });
    pictures.flatten().collect()
}

fn page_of(Plan { report, scene, .. }: &Plan) -> Page {
    cam_page(report, scene.as_ref()).unwrap()
}

/// The cells of the table of the section `title` whose first column begins with `name`.
fn row<'a>(page: &'a Page, title: &str, name: &str) -> &'a [String] {
    let section = page.sections.iter().find(|section| section.title == title).unwrap();
    let rows = section.blocks.iter().filter_map(|block| match block {
        Shown::Table(table) => Some(&table.rows),
        _ => None,
    });
    rows.flatten().find(|row| row[0].starts_with(name)).unwrap()
}

/// Writes the page where a person can look at it, if `HORMA_PAGES` names a folder.
fn show(page: &Page, name: &str) {
    if let Some(folder) = std::env::var_os("HORMA_PAGES") {
        std::fs::write(std::path::Path::new(&folder).join(name), html(page)).unwrap();
    }
}

#[test]
fn the_page_of_a_turned_last_shows_warnings_numbers_pictures_and_travel() {
    let planned = turned_last();
    let page = page_of(&planned);
    show(&page, "last.html");
    assert_eq!(page.title, "left <last>.stl");
    assert_eq!(page.warnings, planned.report.warnings);
    let labels: Vec<_> = page.figures.iter().map(|figure| figure.label.as_str()).collect();
    assert_eq!(
        labels,
        ["Time (h:mm:ss)", "Positions", "Surface", "Within reach", "Stock assumed", "Y travel"]
    );
    let pictures = pictures(&page);
    let is_photo = |picture: &&&Picture| matches!(picture.image, Image::Png(_));
    assert_eq!((pictures.len(), pictures.iter().filter(is_photo).count()), (4, 2));
    assert!(pictures[2].caption.starts_with("The surface unrolled about the spindle"));
    for bounds in &planned.report.program.bounds {
        let travel = row(&page, "Program", &bounds.axis.to_string());
        assert_eq!(travel[1..3], [bounds.least, bounds.greatest].map(|end| format!("{end:.3}")));
    }
}

#[test]
fn the_areas_of_the_page_add_up_to_the_whole_part() {
    let page = page_of(&turned_last());
    let area = |name: &str| row(&page, "Reach and travel", name)[1].parse::<f64>().unwrap();
    let whole = area("the whole part");
    let parts = ["the tool touches", "under a clamp", "in hollows", "undercut"].map(area);
    // Each is rounded to a tenth.
    assert!((parts.iter().sum::<f64>() - whole).abs() < 0.3, "{parts:?} {whole}");
    assert!(parts[0] > 0.9 * whole && parts[1] > 0.0, "{parts:?} {whole}");
}

#[test]
fn the_text_of_the_page_is_safe_whatever_the_file_is_called() {
    let text = html(&page_of(&turned_last()));
    assert!(text.contains("left &lt;last&gt;.stl") && !text.contains("<last>"));
    assert!(text.contains("read in mm &amp; by extent"));
}

#[test]
fn without_a_scene_the_page_has_words_and_the_map_alone() {
    let planned = turned_last();
    let page = cam_page(&planned.report, None).unwrap();
    let images: Vec<_> = pictures(&page).into_iter().map(|picture| &picture.image).collect();
    assert!(matches!(images[..], [Image::Svg(_)]), "{} pictures", images.len());
    assert_eq!(page.figures, page_of(&planned).figures);
}

#[test]
fn the_page_of_a_table_part_is_a_map_from_above_of_what_the_tool_cannot_enter() {
    // A round bar with a groove narrower than the tool.
    let mut part = shapes::stub(64, 20.0, 0.0, 30.0);
    part.append(shapes::stub(64, 14.0, 30.0, 34.0));
    part.append(shapes::stub(64, 20.0, 34.0, 60.0));
    let part = shapes::subdivide(&part);
    let options = CamOptions { pitch: Some(4.0), step: Some(2.0), ..CamOptions::default() };
    let planned = cut(Surface::Mesh(part), "mill-3axis", "ball:6", &options);
    let page = page_of(&planned);
    show(&page, "groove.html");
    let captions: Vec<_> = pictures(&page).iter().map(|picture| &picture.caption).collect();
    assert_eq!(captions.len(), 4);
    assert!(captions[2].starts_with("The surface seen from above"), "{}", captions[2]);
    assert_eq!(page.figures.last().unwrap().label, "Z travel");
}

#[test]
fn a_part_of_few_triangles_has_no_map() {
    let block = Aabb { min: Point3::origin(), max: Point3::new(60.0, 40.0, 20.0) };
    let options = CamOptions { pitch: Some(4.0), overrun: Some(2.0), ..CamOptions::default() };
    let block = Surface::Mesh(shapes::cuboid(&block));
    let page = page_of(&cut(block, "mill-3axis", "ball:3", &options));
    show(&page, "block.html");
    assert_eq!(pictures(&page).len(), 3);
    // Underside and walls are undercut, the top is not.
    assert_eq!(row(&page, "Reach and travel", "the tool touches")[1], "2400.0");
}

#[test]
fn the_page_of_a_cloud_has_pictures_but_no_reach() {
    let cloud = Surface::Points(small_last().into_points());
    let planned = cut(cloud, "last-lathe", "wheel:60,10", &coarse());
    let page = page_of(&planned);
    show(&page, "cloud.html");
    assert_eq!(pictures(&page).len(), 3);
    assert!(page.figures.iter().all(|figure| figure.label != "Within reach"));
}

#[test]
fn the_page_of_a_roughing_tells_what_it_does_and_how_deep_it_cuts() {
    let machine = Machine::builtin("last-lathe").unwrap();
    let job = Job {
        name: "last.stl".into(),
        surface: small_last(),
        notes: Vec::new(),
        dialect: &Dialect::named(&machine.dialect).unwrap(),
        machine: &machine,
        tool: Tool::from_shorthand("wheel:60,10").unwrap(),
        options: &CamOptions { max_depth: Some(9.0), pitch: Some(9.0), ..coarse() },
        keep_scene: false,
    };
    let planned = rough(job, &Block::Cylinder { radius: None }, &Silent).unwrap();
    let page = page_of(&planned);
    assert!(page.subtitle.starts_with("roughed: helix with wheel:60,10 on "), "{}", page.subtitle);
    let figure = |label: &str| {
        let found = page.figures.iter().find(|figure| figure.label == label);
        found.map(|figure| figure.value.as_str())
    };
    assert_eq!((figure("Deepest cut"), figure("Stock assumed")), (Some("≤ 9.0"), None));
    let n_positions = planned.report.rough.as_ref().unwrap().n_positions.to_string();
    assert_eq!(figure("Positions").unwrap().replace(',', ""), n_positions);
    let summary = cam_summary(&planned.report);
    assert!(!summary.contains("\nstock "), "{summary}");
}

#[test]
fn every_strategy_has_its_page_and_its_summary() {
    for (strategy, word) in [
        (Strategy::Helix, "run         helix, "),
        (Strategy::Rings, "run         rings, "),
        (Strategy::Lines, "run         lines, "),
    ] {
        let options = CamOptions { strategy: Some(strategy), ..coarse() };
        let planned = cut(small_last(), "last-lathe", "wheel:60,10", &options);
        let page = page_of(&planned);
        assert!(
            page.subtitle
                .starts_with(word.split_whitespace().last().unwrap().trim_end_matches(','))
        );
        assert!(cam_summary(&planned.report).contains(word), "{}", cam_summary(&planned.report));
        show(&page, &format!("{strategy:?}.html"));
    }
}

#[test]
fn violations_come_first_on_the_page_and_last_in_the_summary() {
    let mut planned = turned_last();
    let violation = Violation { line: 17, kind: ViolationKind::NoFeed };
    planned.report.program.violations = vec![violation; 51];
    let page = page_of(&planned);
    assert_eq!(
        page.warnings[0],
        "the program must not run on last-lathe: 51 violations, listed below"
    );
    assert_eq!(row(&page, "Program", "17")[1], "a G1 without a feed in force");
    assert!(html(&page).contains("<p>... and 1 more.</p>"));
    let summary = cam_summary(&planned.report);
    let told = "\nviolations  51, the first in line 17: a G1 without a feed in force\n";
    assert!(summary.ends_with(told), "{summary}");
}

#[test]
fn the_summary_is_a_dozen_lines_of_names_and_values() {
    let planned = turned_last();
    let summary = cam_summary(&planned.report);
    let lines: Vec<_> = summary.lines().collect();
    assert!((10..18).contains(&lines.len()), "{summary}");
    for line in &lines {
        let (name, value) = line.split_at(12);
        assert!(!name.starts_with(' ') && name.ends_with(' ') && !value.starts_with(' '), "{line}");
    }
    let n_warnings = lines.iter().filter(|line| line.starts_with("warning ")).count();
    assert_eq!(n_warnings, planned.report.warnings.len());
    assert!(lines[2].ends_with(" wheel:60,10"), "said once: {}", lines[2]);
}

#[test]
fn the_page_of_a_scanned_foot_is_made() {
    let Some(file) = real("lasts/find_foot/foot_mean_left.obj") else { return };
    let surface = read_surface(&file, None).unwrap().surface;
    let planned = cut(surface, "last-lathe", "wheel:60,10", &coarse());
    let page = page_of(&planned);
    show(&page, "foot.html");
    assert_eq!(pictures(&page).len(), 4);
}

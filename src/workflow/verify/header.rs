//! What the head of a program says about how it was made.

use crate::gcode::{BlockKind, Program};
use crate::workflow::cam::CamOptions;

/// What the head of a program says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Asked {
    /// The options it was made with.
    pub options: Option<CamOptions>,
    /// The most material it assumes over the part [mm].
    pub stock: Option<f64>,
}

/// Why the head cannot be understood.
#[derive(Debug, thiserror::Error)]
#[error(
    "the options in the program's header cannot be understood ({problem}); the program was made by \
     another version of horma: give its options on the command line, with --no-header"
)]
pub struct HeaderError {
    problem: serde_json::Error,
}

/// Reads the remarks of `program`: a header of ours, or nothing.
pub fn asked(program: &Program) -> Result<Asked, HeaderError> {
    let remarks: Vec<&str> = program
        .blocks
        .iter()
        .take_while(|block| !matches!(block.kind, BlockKind::Move(_)))
        .filter_map(|block| match &block.kind {
            BlockKind::Comment(text) => Some(text.trim()),
            _ => None,
        })
        .collect();
    let stock = remarks.iter().find_map(|text| {
        let number = text.strip_prefix("assumes at most ")?.strip_suffix(" mm of stock")?;
        number.parse().ok()
    });
    let Some(first) = remarks.iter().position(|text| text.starts_with("options {")) else {
        return Ok(Asked { options: None, stock });
    };
    // A long remark is broken into lines, at a blank where there was one, else anywhere.
    let lines = &remarks[first..];
    let end = lines.iter().position(|text| text.ends_with('}')).map_or(lines.len(), |end| end + 1);
    let parse = |glue: &str| {
        let whole = lines[..end].join(glue);
        serde_json::from_str(whole.strip_prefix("options ").unwrap_or(&whole))
    };
    let options = parse(" ").or_else(|_| parse("")).map_err(|problem| HeaderError { problem })?;
    Ok(Asked { options: Some(options), stock })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(remarks: &[&str]) -> Program {
        let mut program = Program::default();
        for text in remarks {
            program.push(BlockKind::Comment((*text).into()));
        }
        program
    }

    #[test]
    fn options_and_stock_are_read_from_the_header_even_over_two_lines() {
        let head = program(&[
            "part foot.obj",
            "options {\"pitch\":1.0,\"axis\":\"1 0",
            "0.2\"}",
            "made by horma 0.1.0",
            "assumes at most 12.50 mm of stock",
        ]);
        let asked = asked(&head).unwrap();
        let options = asked.options.unwrap();
        assert_eq!((options.pitch, options.axis.as_deref()), (Some(1.0), Some("1 0 0.2")));
        assert_eq!(asked.stock, Some(12.5));
    }

    #[test]
    fn a_program_from_elsewhere_asks_for_nothing() {
        assert_eq!(asked(&program(&["a bracket"])).unwrap(), Asked::default());
    }

    #[test]
    fn an_option_nobody_knows_is_named() {
        let message = asked(&program(&["options {\"wobble\":1}"])).unwrap_err().to_string();
        assert!(message.contains("unknown field `wobble`"), "{message}");
    }
}

//! Exit codes, after `sysexits.h`: 0 done, 2 usage, 65 bad input, 70 our fault, 73 cannot write,
//! 75 try again.

use horma::{io::WriteError, progress::Cancelled};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The command line is wrong.
const USAGE: u8 = 2;
/// Something the user gave cannot be used.
const BAD_INPUT: u8 = 65;
/// A bug: horma panicked.
const OUR_FAULT: u8 = 70;
/// An output could not be written.
const CANNOT_WRITE: u8 = 73;
/// Stopped half-way; nothing is wrong with the input.
pub(crate) const TRY_AGAIN: u8 = 75;

/// The command line lacks something that it alone, or a job file, could say.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct Usage(pub(crate) String);

/// Runs `job`, tells its error on stderr, and says how the process shall end.
pub(crate) fn code_of(job: impl FnOnce() -> anyhow::Result<()>) -> u8 {
    match catch_unwind(AssertUnwindSafe(job)) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => {
            tell(&format!("error: {}", sentence(&error)));
            code(&error)
        }
        Err(_) => {
            tell(concat!(
                "error: this is a bug in horma ",
                env!("CARGO_PKG_VERSION"),
                ", not in your input; please report the lines above and the command"
            ));
            OUR_FAULT
        }
    }
}

/// Has a panic tell where it happened in one line; `RUST_BACKTRACE` brings back the long form.
pub(crate) fn shorten_panics() {
    if std::env::var_os("RUST_BACKTRACE").is_none() {
        std::panic::set_hook(Box::new(|panic| {
            let place = panic.location().map(ToString::to_string).unwrap_or_default();
            tell(&format!(
                "panic at {place}: {}",
                panic.payload_as_str().unwrap_or("(no message)")
            ));
        }));
    }
}

/// Says one line on stderr; if that is gone too, there is nobody to tell.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

fn code(error: &anyhow::Error) -> u8 {
    // A transparent variant, as every module has for it, hides the type but forwards the words.
    let cancelled = Cancelled.to_string();
    if error.chain().any(|cause| cause.to_string() == cancelled) {
        TRY_AGAIN
    } else if error.chain().any(|cause| cause.downcast_ref::<WriteError>().is_some()) {
        CANNOT_WRITE
    } else if error.is::<Usage>() {
        USAGE
    } else {
        BAD_INPUT
    }
}

/// The chain of causes as one sentence; a cause that an outer message quotes is not said again.
fn sentence(error: &anyhow::Error) -> String {
    let mut said = String::new();
    let mut outer = String::new();
    for cause in error.chain() {
        let message = cause.to_string();
        if outer.contains(&message) {
            continue;
        }
        if !said.is_empty() {
            said.push_str(": ");
        }
        said.push_str(message.trim_end());
        outer = message;
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::{Context, anyhow};
    use std::io;

    fn full_disk() -> WriteError {
        let source = io::Error::from(io::ErrorKind::StorageFull);
        WriteError::System { path: "out.ngc".into(), source }
    }

    #[test]
    fn every_end_has_its_code() {
        assert_eq!(code_of(|| Ok(())), 0);
        assert_eq!(code_of(|| Err(Usage("a part to cut is missing".into()).into())), 2);
        assert_eq!(code_of(|| Err(anyhow!("no triangles"))), 65);
        assert_eq!(code_of(|| panic!("a bug, made up for this test")), 70);
        assert_eq!(code_of(|| Err(full_disk()).context("while writing")), 73);
        assert_eq!(code_of(|| Err(Cancelled).context("while digitizing")), 75);
        assert_eq!(code_of(|| Err(WriteError::from(Cancelled).into())), 75);
    }

    #[test]
    fn a_chain_says_each_cause_once() {
        let source = io::Error::from_raw_os_error(2);
        let error = anyhow::Error::new(source).context("while reading \"left.stl\"");
        assert_eq!(
            sentence(&error),
            "while reading \"left.stl\": No such file or directory (os error 2)"
        );
    }

    #[test]
    fn a_cause_that_is_quoted_already_is_not_repeated() {
        let error = anyhow::Error::new(full_disk()).context("while writing the program");
        assert_eq!(
            sentence(&error),
            "while writing the program: cannot write \"out.ngc\": no storage space; \
             make room or write somewhere else"
        );
    }

    /// In a process of its own, because the panic hook belongs to the whole process.
    #[test]
    fn a_panic_is_one_line_and_the_request_to_report_it() {
        let child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "exit::tests::a_job_with_a_bug", "--ignored", "--nocapture"])
            .env(CHILD, "1")
            .env_remove("RUST_BACKTRACE")
            .output()
            .unwrap();
        assert_eq!(child.status.code(), Some(70));
        let said = String::from_utf8(child.stderr).unwrap();
        let lines: Vec<_> = said.lines().collect();
        assert_eq!(lines.len(), 2, "{said}");
        assert!(lines[0].starts_with("panic at src/bin/horma/exit.rs:"), "{said}");
        assert!(lines[0].ends_with(": made up: 7"), "{said}");
        assert!(lines[1].starts_with("error: this is a bug in horma "), "{said}");
    }

    const CHILD: &str = "HORMA_TEST_CHILD_PANICS";

    #[test]
    #[ignore = "a child of the test above"]
    fn a_job_with_a_bug() {
        if std::env::var_os(CHILD).is_some() {
            shorten_panics();
            std::process::exit(code_of(|| panic!("made up: {}", 7)).into());
        }
    }
}

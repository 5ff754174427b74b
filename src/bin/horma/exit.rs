//! Exit codes, after `sysexits.h`: 0 done, 2 usage, 65 bad input, 70 our fault, 73 cannot write,
//! 75 try again.

use horma::{io::WriteError, progress::Cancelled};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

/// Something the user gave cannot be used.
const BAD_INPUT: u8 = 65;
/// A bug: horma panicked.
const OUR_FAULT: u8 = 70;
/// An output could not be written.
const CANNOT_WRITE: u8 = 73;
/// Stopped half-way; nothing is wrong with the input.
const TRY_AGAIN: u8 = 75;

/// Runs `job`, tells its error on stderr, and says how the process shall end.
pub(crate) fn code_of(job: impl FnOnce() -> anyhow::Result<()>) -> ExitCode {
    match catch_unwind(AssertUnwindSafe(job)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            eprintln!("error: {error:#}");
            ExitCode::from(code(&error))
        }
        Err(_) => {
            eprintln!(
                "error: this is a bug in horma, not in your input; please report the lines above"
            );
            ExitCode::from(OUR_FAULT)
        }
    }
}

fn code(error: &anyhow::Error) -> u8 {
    if error.chain().any(|cause| cause.is::<WriteError>()) {
        CANNOT_WRITE
    } else if error.chain().any(|cause| cause.is::<Cancelled>()) {
        TRY_AGAIN
    } else {
        BAD_INPUT
    }
}

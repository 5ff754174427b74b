//! Ctrl-C: the first one asks the work under way to stop, the next one ends horma at once. Neither
//! leaves a file half-written.

use crate::exit;
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// While one lives, work is under way that looks at [`requested`] often.
#[derive(Debug)]
pub(crate) struct Listening(());

/// Takes over Ctrl-C for this process; call it once.
pub(crate) fn take_over() -> anyhow::Result<()> {
    // The handler runs in a thread of its own, so it may lock and write.
    Ok(ctrlc::set_handler(on_interrupt)?)
}

/// True once the user asked to stop.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

impl Listening {
    /// Says that somebody listens from now on.
    pub(crate) fn begin() -> Self {
        N_LISTENING.fetch_add(1, Ordering::Relaxed);
        Self(())
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        N_LISTENING.fetch_sub(1, Ordering::Relaxed);
    }
}

static REQUESTED: AtomicBool = AtomicBool::new(false);
static N_LISTENING: AtomicUsize = AtomicUsize::new(0);

fn on_interrupt() {
    let first = !REQUESTED.swap(true, Ordering::Relaxed);
    if first && 0 < N_LISTENING.load(Ordering::Relaxed) {
        let _ = writeln!(std::io::stderr(), "\nstopping; Ctrl-C again ends at once");
    } else {
        horma::io::abandon_unfinished(|| std::process::exit(exit::TRY_AGAIN.into()));
    }
}

/// Each case runs in a process of its own: this test binary again, told to run one ignored test.
#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::bar::Bar;
    use horma::io::{Overwrite, write_file};
    use horma::progress::Progress;
    use std::io::{BufRead, BufReader, Read};
    use std::path::{Path, PathBuf};
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    const FOLDER: &str = "HORMA_TEST_CHILD_FOLDER";

    #[test]
    fn the_first_ctrl_c_stops_work_that_listens() {
        let folder = tempfile::tempdir().unwrap();
        let child = Working::start("work_that_listens", folder.path());
        child.interrupt();
        let (code, said) = child.wait();
        assert_eq!(code, 75);
        // Nothing else: a bar draws on a terminal only.
        assert_eq!(
            said,
            "begun\n\nstopping; Ctrl-C again ends at once\n\
             error: stopped on request; nothing was written\n"
        );
        assert!(is_empty(folder.path()));
    }

    #[test]
    fn the_second_ctrl_c_ends_at_once_and_removes_what_was_begun() {
        let folder = tempfile::tempdir().unwrap();
        let mut child = Working::start("work_that_is_deaf", folder.path());
        child.interrupt();
        child.read_until("stopping");
        assert!(!is_empty(folder.path()));
        child.interrupt();
        assert_eq!(child.wait().0, 75);
        assert!(is_empty(folder.path()));
    }

    #[test]
    fn the_first_ctrl_c_ends_at_once_when_nobody_listens() {
        let folder = tempfile::tempdir().unwrap();
        let child = Working::start("work_without_a_bar", folder.path());
        child.interrupt();
        assert_eq!(child.wait().0, 75);
        assert!(is_empty(folder.path()));
    }

    #[test]
    #[ignore = "a child of the tests above"]
    fn work_that_listens() {
        work(|| {
            let bar = Bar::new(false);
            move || bar.advance(0).map_err(std::io::Error::other)
        });
    }

    #[test]
    #[ignore = "a child of the tests above"]
    fn work_that_is_deaf() {
        work(|| {
            let bar = Bar::new(false);
            move || {
                let _ = &bar;
                Ok(())
            }
        });
    }

    #[test]
    #[ignore = "a child of the tests above"]
    fn work_without_a_bar() {
        work(|| || Ok(()));
    }

    /// Writes a file that is never done, calling what `prepare` returns between bytes.
    fn work<S: FnMut() -> std::io::Result<()>>(prepare: impl FnOnce() -> S) {
        let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
        let code = exit::code_of(|| {
            take_over()?;
            let mut step = prepare();
            write_file(&folder.join("out.ngc"), Overwrite::Refuse, |out| {
                let _ = writeln!(std::io::stderr(), "begun");
                loop {
                    out.write_all(&[b'x'; 4096])?;
                    step()?;
                    std::thread::sleep(Duration::from_millis(5));
                }
            })?;
            Ok(())
        });
        std::process::exit(code.into());
    }

    struct Working {
        child: Child,
        stderr: BufReader<std::process::ChildStderr>,
        said: String,
    }

    impl Working {
        fn start(test: &str, folder: &Path) -> Self {
            let mut child = Command::new(std::env::current_exe().unwrap())
                .args(["--exact", &format!("interrupt::tests::{test}"), "--ignored", "--nocapture"])
                .env(FOLDER, folder)
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let stderr = BufReader::new(child.stderr.take().unwrap());
            let mut working = Self { child, stderr, said: String::new() };
            working.read_until("begun");
            working
        }

        fn read_until(&mut self, word: &str) {
            while !self.said.contains(word) {
                let n_bytes = self.stderr.read_line(&mut self.said).unwrap();
                assert_ne!(n_bytes, 0, "ended before it said {word:?}: {}", self.said);
            }
        }

        fn interrupt(&self) {
            let id = self.child.id().to_string();
            assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        }

        fn wait(mut self) -> (i32, String) {
            let begin = Instant::now();
            let status = loop {
                if let Some(status) = self.child.try_wait().unwrap() {
                    break status;
                }
                if Duration::from_secs(30) < begin.elapsed() {
                    self.child.kill().unwrap();
                }
                std::thread::sleep(Duration::from_millis(5));
            };
            self.stderr.read_to_string(&mut self.said).unwrap();
            (status.code().expect("it ends by itself"), std::mem::take(&mut self.said))
        }
    }

    /// A test that fails half-way leaves no child behind.
    impl Drop for Working {
        fn drop(&mut self) {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }

    fn is_empty(folder: &Path) -> bool {
        std::fs::read_dir(folder).unwrap().next().is_none()
    }
}

//! The frame every subcommand runs in: help, exit codes, and readers that leave early.

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Runs `horma` with `arguments`.
pub(crate) fn horma(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_horma")).args(arguments).output().unwrap()
}

/// The help of the subcommand `command` (of horma itself if empty); it must be told on stdout.
pub(crate) fn help(command: &[&str]) -> String {
    let output = horma(&[command, &["--help"]].concat());
    assert_eq!(output.status.code(), Some(0), "{command:?} --help");
    assert!(output.stderr.is_empty(), "{command:?} --help writes to stderr");
    String::from_utf8(output.stdout).unwrap()
}

/// The subcommands that `command` lists in its help.
pub(crate) fn subcommands(command: &[&str]) -> Vec<String> {
    help(command)
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        // A description that goes on in the next line is indented further.
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .map(String::from)
        .collect()
}

#[test]
fn help_starts_with_the_two_commands_a_new_user_needs() {
    for arguments in [&["help"][..], &["--help"], &["-h"]] {
        let output = horma(arguments);
        assert_eq!(output.status.code(), Some(0));
        let text = String::from_utf8(output.stdout).unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[0], "Start here:");
        assert!(lines[1].starts_with("  horma demo "), "{text}");
        assert!(lines[2].starts_with("  horma cam part.stl -m last-lathe -o part.ngc "), "{text}");
    }
}

#[test]
fn every_subcommand_has_help_with_an_example_of_its_usage() {
    let names = subcommands(&[]);
    assert!(names.contains(&"completions".to_owned()), "{names:?}");
    for name in &names {
        assert!(help(&[name]).contains(&format!("Usage: horma {name}")), "{name}");
        for inner in subcommands(&[name]) {
            let text = help(&[name, &inner]);
            assert!(text.contains(&format!("Usage: horma {name} {inner}")), "{name} {inner}");
        }
    }
}

#[test]
fn a_wrong_command_line_exits_with_2_and_says_what_is_wrong() {
    for (arguments, expected) in [
        (&[][..], "Start here:"),
        (&["--no-such-flag"], "unexpected argument '--no-such-flag'"),
        (&["no-such-command"], "unrecognized subcommand 'no-such-command'"),
        (&["completions"], "<SHELL>"),
        (&["completions", "tcsh"], "[possible values: bash, elvish, fish, powershell, zsh]"),
        (&["--threads", "0", "completions", "bash"], "0 is not in 1..=1024"),
        (&["--threads", "many", "completions", "bash"], "invalid digit found in string"),
    ] {
        let output = horma(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains(expected), "{arguments:?}: {told}");
    }
}

#[test]
fn the_version_is_that_of_the_package() {
    let output = horma(&["--version"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stdout, concat!("horma ", env!("CARGO_PKG_VERSION"), "\n").as_bytes());
}

#[test]
fn completions_are_made_for_every_shell() {
    for (shell, expected) in [
        ("bash", "complete -F _horma"),
        ("zsh", "#compdef horma"),
        ("fish", "complete -c horma"),
        ("powershell", "Register-ArgumentCompleter"),
        ("elvish", "set edit:completion:arg-completer[horma]"),
    ] {
        let output = horma(&["--threads", "1", "completions", shell]);
        assert_eq!(output.status.code(), Some(0), "{shell}");
        assert!(output.stderr.is_empty(), "{shell}");
        assert!(String::from_utf8(output.stdout).unwrap().contains(expected), "{shell}");
    }
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = Command::new(env!("CARGO_BIN_EXE_horma"))
        .args(["completions", "bash"])
        .stdout(writer)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_exits_with_73() {
    let full = std::fs::File::options().write(true).open(Path::new("/dev/full")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_horma"))
        .args(["completions", "bash"])
        .stdout(full)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(output.status.code(), Some(73));
    assert_eq!(
        String::from_utf8(output.stderr).unwrap(),
        "error: cannot write \"standard output\": No space left on device (os error 28); \
         make room or write somewhere else\n"
    );
}

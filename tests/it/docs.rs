//! The documents say what is there, and what they tell people to run is what we run.

use crate::command::{help, subcommands};
use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 6] = [
    "README.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "EXPERIMENTS.md",
    "kernels/README.md",
];

#[test]
fn the_two_commands_of_the_readme_are_the_first_and_what_ci_runs() {
    let readme = read("README.md");
    let commands: Vec<_> = readme.lines().filter(|line| line.starts_with("cargo ")).collect();
    assert_eq!(commands[..2], ["cargo run --release -- demo", "cargo test"]);
    let script = read(".ci/run");
    let last: Vec<_> = script.lines().rev().take(2).collect();
    assert_eq!(last, ["$test_command", "test_command=$(grep -m1 '^cargo test' README.md)"]);
}

#[test]
fn every_machine_example_and_dialect_is_named() {
    let pages = read("README.md") + &read("ARCHITECTURE.md");
    for folder in ["machines", "examples", "kernels"] {
        for path in files_under(&root().join(folder)) {
            let path = path.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
            let stem = Path::new(&path).file_stem().unwrap().to_str().unwrap();
            let named = pages.contains(&path) || pages.contains(&format!("`{stem}`"));
            assert!(named, "neither README.md nor ARCHITECTURE.md names {path}");
        }
    }
}

#[test]
fn the_exit_codes_of_readme_and_help_are_the_same() {
    let table: Vec<_> = read("README.md")
        .lines()
        .skip_while(|line| !line.starts_with("| exit code |"))
        .skip(2)
        .map_while(|line| line.strip_prefix("| ")?.strip_suffix(" |").map(String::from))
        .map(|row| row.split_once(" | ").map(|(code, text)| format!("  {code:<3} {text}")).unwrap())
        .collect();
    let help = help(&[]);
    let (_, codes) = help.split_once("Exit codes:\n").unwrap();
    assert_eq!(table, codes.trim_end().lines().collect::<Vec<_>>());
    assert_eq!(table.len(), 6);
}

#[test]
fn every_subcommand_is_in_the_readme() {
    let readme = read("README.md");
    for name in subcommands(&[]) {
        assert!(readme.contains(&format!("horma {name}")), "README.md does not show horma {name}");
    }
}

#[test]
fn every_command_of_the_readme_exists_with_its_flags() {
    let readme = read("README.md");
    let lines: Vec<_> = readme.lines().filter(|line| line.starts_with("horma ")).collect();
    assert!(8 < lines.len());
    for line in lines {
        let command = line.split('#').next().unwrap();
        let words: Vec<_> = command.split_whitespace().skip(1).collect();
        let n_names = if subcommands(&words[..1]).is_empty() { 1 } else { 2 };
        let help = help(&words[..n_names]);
        for flag in words.iter().filter(|word| word.starts_with('-')) {
            let known =
                help.split(|c: char| c.is_whitespace() || c == ',').any(|word| word == *flag);
            assert!(known, "`{line}`: {flag} is not in the help");
        }
    }
}

#[test]
fn every_picture_of_the_documents_is_there() {
    check_links(true);
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    check_links(false);
}

#[test]
fn the_changelog_knows_this_version() {
    assert!(read("CHANGELOG.md").contains(&format!("## [{}]", env!("CARGO_PKG_VERSION"))));
}

/// Checks `![text](path)` or `[text](path)`, except for addresses elsewhere.
fn check_links(pictures: bool) {
    let mut n_links = 0;
    for document in DOCUMENTS {
        let folder = root().join(document).parent().unwrap().to_owned();
        let text = read(document);
        for (at, _) in text.match_indices("](") {
            let is_picture = text[..at].rfind('[').is_some_and(|from| text[..from].ends_with('!'));
            let target = text[at + 2..].split([')', '#']).next().unwrap();
            if is_picture == pictures && !target.is_empty() && !target.contains("://") {
                n_links += 1;
                assert!(folder.join(target).exists(), "{document} leads to {target}");
            }
        }
    }
    assert_ne!(n_links, 0);
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

/// All files in `folder` and its folders; none if it is not there.
fn files_under(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.flat_map(|path| if path.is_dir() { files_under(&path) } else { vec![path] }).collect()
}

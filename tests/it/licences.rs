//! Every crate horma is built from may be used under a licence we accept.

use cargo_metadata::{MetadataCommand, Package};
use std::path::Path;
use std::process::Command;

const ACCEPTED: [&str; 14] = [
    "0BSD",
    "Apache-2.0 WITH LLVM-exception",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MPL-2.0",
    "OFL-1.1",
    "Ubuntu-font-1.0",
    "Unicode-3.0",
    "Zlib",
];

/// Crates whose manifest names only a file: crate, version read, licence found in it, and the line
/// of the file that says so.
const BY_FILE: [(&str, &str, &str, &str); 1] = [("pcd-rs", "0.13.0", "MIT", "MIT License")];

#[test]
fn every_dependency_has_an_accepted_licence() {
    let packages = packages();
    assert!(packages.iter().any(|package| package.name == "horma"));
    assert!(10 < packages.len(), "the dependencies were not listed");
    let refused: Vec<_> = packages
        .iter()
        .filter_map(|package| judge(package).err().map(|why| format!("{}: {why}", package.name)))
        .collect();
    assert!(refused.is_empty(), "\n{}", refused.join("\n"));
}

#[test]
fn deny_toml_accepts_the_same_licences() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml");
    let table: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let allowed: Vec<_> = table["licenses"]["allow"]
        .as_array()
        .unwrap()
        .iter()
        .map(|licence| licence.as_str().unwrap())
        .collect();
    assert_eq!(allowed, ACCEPTED);
}

#[test]
fn expressions_are_satisfied_by_any_of_or_and_all_of_and() {
    for (expression, expected) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("Unlicense OR MIT", true),
        ("MIT/Apache-2.0", true),
        ("GPL-2.0 / LGPL-2.1", false),
        ("MIT AND GPL-3.0", false),
        ("(MIT OR GPL-3.0) AND Unicode-3.0", true),
        ("MIT AND GPL-3.0 OR Zlib", true),
        ("GPL-3.0 OR MIT AND LGPL-2.1", false),
        ("GPL-3.0 OR (MIT AND (ISC OR LGPL-2.1))", true),
        ("Apache-2.0 WITH LLVM-exception", true),
        ("GPL-2.0 WITH Classpath-exception-2.0", false),
        ("MIT WITH LLVM-exception", false),
        ("MIT+", false),
    ] {
        assert_eq!(is_satisfied(expression), Ok(expected), "{expression}");
    }
}

#[test]
fn malformed_expressions_are_refused() {
    for expression in ["", "MIT OR", "(MIT", "MIT)", "MIT Apache-2.0", "AND MIT", "MIT WITH"] {
        assert!(is_satisfied(expression).is_err(), "{expression}");
    }
}

fn judge(package: &Package) -> Result<(), String> {
    if let Some(expression) = &package.license {
        let satisfied = is_satisfied(expression)?;
        return satisfied.then_some(()).ok_or_else(|| format!("{expression} is not accepted"));
    }
    let version = package.version.to_string();
    let Some((.., licence, line)) =
        BY_FILE.iter().find(|(name, read, ..)| package.name == name && version == *read)
    else {
        return Err(format!("version {version} names no licence; read its file and add it here"));
    };
    let file = package.license_file().ok_or("its licence file is gone")?;
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
    if text.lines().any(|found| found.trim() == *line) && ACCEPTED.contains(licence) {
        Ok(())
    } else {
        Err(format!("{file} is not the {licence} licence it was"))
    }
}

/// The packages of this build. Those of other platforms are not downloaded here; their licences
/// are for `cargo deny`.
fn packages() -> Vec<Package> {
    let rustc = Command::new("rustc").arg("-vV").output().unwrap();
    let version = String::from_utf8(rustc.stdout).unwrap();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let options = ["--locked", "--offline", "--filter-platform", host];
    let metadata = MetadataCommand::new()
        .manifest_path(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"))
        .other_options(options.map(String::from).to_vec())
        .exec()
        .unwrap();
    metadata.packages
}

/// Whether we may use what is licensed under an SPDX expression, choosing freely at each `OR`
/// (or `/`, as older manifests write it).
fn is_satisfied(expression: &str) -> Result<bool, String> {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<_> = spaced.split_whitespace().collect();
    let mut rest = words.as_slice();
    let satisfied = any_of(&mut rest)?;
    match rest {
        [] => Ok(satisfied),
        [word, ..] => Err(format!("{word:?} is out of place in {expression:?}")),
    }
}

fn any_of(rest: &mut &[&str]) -> Result<bool, String> {
    let mut satisfied = all_of(rest)?;
    while let ["OR", tail @ ..] = rest {
        *rest = tail;
        satisfied |= all_of(rest)?;
    }
    Ok(satisfied)
}

fn all_of(rest: &mut &[&str]) -> Result<bool, String> {
    let mut satisfied = one(rest)?;
    while let ["AND", tail @ ..] = rest {
        *rest = tail;
        satisfied &= one(rest)?;
    }
    Ok(satisfied)
}

fn one(rest: &mut &[&str]) -> Result<bool, String> {
    match rest {
        ["(", tail @ ..] => {
            *rest = tail;
            let satisfied = any_of(rest)?;
            let [")", tail @ ..] = rest else { return Err("a parenthesis stays open".to_owned()) };
            *rest = tail;
            Ok(satisfied)
        }
        [] | [")" | "OR" | "AND" | "WITH", ..] | [_, "WITH"] => {
            Err("a licence is missing".to_owned())
        }
        [licence, "WITH", exception, tail @ ..] => {
            *rest = tail;
            Ok(ACCEPTED.contains(&format!("{licence} WITH {exception}").as_str()))
        }
        [licence, tail @ ..] => {
            *rest = tail;
            Ok(ACCEPTED.contains(licence))
        }
    }
}

//! The layers and the rules of place of `ARCHITECTURE.md`, held over the sources.

use crate::source::{Kind, Token, paths, tokens};
use std::fs;
use std::path::Path;

/// A module names only modules to its left.
const ORDER: [&str; 15] = [
    "progress",
    "geom",
    "compute",
    "rgbd",
    "register",
    "represent",
    "tool",
    "machine",
    "stock",
    "cam",
    "gcode",
    "measure",
    "workflow",
    "io",
    "bin",
];

#[test]
fn the_sources_keep_the_layers_and_the_rules_of_place() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let sources = sources_under(&root, &root);
    assert!(sources.iter().any(|(path, _)| path == "lib.rs"));
    assert!(sources.iter().any(|(path, _)| path == "bin/horma/main.rs"));
    let breaches: Vec<_> =
        sources.iter().flat_map(|(path, source)| breaches(path, source)).collect();
    assert!(breaches.is_empty(), "\n{}", breaches.join("\n"));
}

#[test]
fn the_architecture_page_states_the_order() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md");
    let text: Vec<_> =
        fs::read_to_string(page).unwrap().split_whitespace().map(String::from).collect();
    assert!(text.join(" ").contains(&ORDER.join(" < ")));
}

#[test]
fn each_breach_is_reported_with_its_line() {
    for (path, source, expected) in [
        // Layers.
        ("geom/mesh.rs", "use crate::cam::Toolpath;", "1: geom names cam, which lies above it"),
        (
            "geom/mesh.rs",
            "\nuse crate::{Point3, io::{self, X}};",
            "2: geom names io, which lies above it",
        ),
        (
            "tool/mod.rs",
            "fn f() { crate::machine::g() }",
            "1: tool names machine, which lies above it",
        ),
        ("tool/mod.rs", "use super::gcode;", "1: tool names gcode, which lies above it"),
        (
            "tool/profile.rs",
            "use super::super::gcode::X;",
            "1: tool names gcode, which lies above it",
        ),
        ("progress.rs", "use super::geom;", "1: progress names geom, which lies above it"),
        ("cam/mod.rs", "use crate::*;", "1: cam names the whole crate; name the module"),
        ("helpers/mod.rs", "", "helpers is not in the order of layers"),
        ("helpers.rs", "", "helpers is not in the order of layers"),
        // Files.
        ("cam/mod.rs", "use std::fs;", "1: cam touches files; that is for io"),
        ("cam/mod.rs", "use std::{fmt, fs::read};", "1: cam touches files; that is for io"),
        ("cam/mod.rs", "fn f() { File::open(p); }", "1: cam touches files; that is for io"),
        ("cam/mod.rs", "fn f() { p.is_dir(); }", "1: cam touches files; that is for io"),
        ("cam/mod.rs", "use tempfile::NamedTempFile;", "1: cam touches files; that is for io"),
        ("lib.rs", "pub use std::fs::read;", "1: lib touches files; that is for io"),
        // Printing.
        ("io/mod.rs", "fn f() { eprintln!(\"x\"); }", "1: io prints; that is for the binary"),
        ("cam/mod.rs", "fn f() { dbg!(1); }", "1: cam prints; that is for the binary"),
        ("cam/mod.rs", "fn f() { std::io::stdout(); }", "1: cam prints; that is for the binary"),
        (
            "bin/horma/cli/a.rs",
            "fn f() { println!(); }",
            "1: bin prints with println!, which panics when its reader leaves; use cli::print",
        ),
        // Hardware and window.
        ("cam/mod.rs", "fn f(d: &wgpu::Device) {}", "1: cam names wgpu; that is for compute"),
        ("compute/mod.rs", "use egui::Ui;", "1: compute names the window; that is for the binary"),
        (
            "workflow/mod.rs",
            "use eframe::App;",
            "1: workflow names the window; that is for the binary",
        ),
        // G-words.
        ("cam/mod.rs", "const S: &str = \"G1 X0\";", "1: cam writes a G-word; that is for gcode"),
        ("io/mod.rs", "fn f() { w(r#\"x g93\"#) }", "1: io writes a G-word; that is for gcode"),
        (
            "machine/mod.rs",
            "const S: &str = \"N10G38.2\";",
            "1: machine writes a G-word; that is for gcode",
        ),
    ] {
        assert_eq!(breaches(path, source), [format!("src/{path}:{expected}")], "{source}");
    }
}

#[test]
fn what_keeps_the_rules_is_not_reported() {
    for (path, source) in [
        ("cam/mod.rs", "use crate::{geom::Pose, machine::Machine}; use super::tool::Tool;"),
        ("cam/a/b.rs", "use super::gcode; use super::super::io; // modules of cam's own"),
        ("bin/horma/main.rs", "use horma::io; use crate::cam; fn f() { eprintln!(\"G1\") }"),
        ("io/mod.rs", "use std::fs; fn f() { File::open(p); std::io::stdout(); }"),
        ("compute/gpu.rs", "use wgpu::Device;"),
        ("gcode/mod.rs", "const RAPID: &str = \"G0\";"),
        ("cam/mod.rs", "//! crate::io, println!, \"G1\"\n/* std::fs */ fn f() {}"),
        ("cam/mod.rs", "#[cfg(test)]\nmod tests { use crate::io; fn f() { println!(\"G1\") } }"),
        ("cam/mod.rs", "const S: &str = \"RG1 BIG2 G G1234 std::fs crate::io\";"),
        ("lib.rs", "pub mod cam; pub mod io;"),
    ] {
        assert_eq!(breaches(path, source), [""; 0], "{source}");
    }
}

/// Every rule broken by the file `path` (under `src/`), one line each.
fn breaches(path: &str, source: &str) -> Vec<String> {
    let own = path.split('/').next().unwrap_or(path).trim_end_matches(".rs");
    let Some(rank) = ORDER.iter().position(|name| *name == own).or((own == "lib").then_some(0))
    else {
        return vec![format!("src/{path}:{own} is not in the order of layers")];
    };
    let tokens = tokens(source);
    let mut found = place_breaches(own, &tokens);
    // The root only declares modules, and in the binary `crate` is the binary.
    if own != "lib" && own != "bin" {
        found.extend(layer_breaches(path, rank, &tokens));
    }
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(|(line, what)| format!("src/{path}:{line}: {own} {what}")).collect()
}

fn layer_breaches(path: &str, rank: usize, tokens: &[Token]) -> Vec<(usize, String)> {
    // As many `super` lead from here to the root of the crate.
    let depth = path.trim_end_matches(".rs").trim_end_matches("/mod").split('/').count();
    let mut found = Vec::new();
    for (path, line) in paths(tokens) {
        let n_supers = path.iter().take_while(|word| *word == "super").count();
        let below_root = match path[0].as_str() {
            "crate" => &path[1..],
            "super" if n_supers == depth => &path[n_supers..],
            _ => continue,
        };
        let Some(named) = below_root.first() else { continue };
        if named == "*" {
            found.push((line, "names the whole crate; name the module".to_owned()));
        }
        if ORDER.iter().position(|name| name == named).is_some_and(|other| rank < other) {
            found.push((line, format!("names {named}, which lies above it")));
        }
    }
    found
}

fn place_breaches(own: &str, tokens: &[Token]) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut unless_in = |rooms: &[&str], line: usize, what: &str| {
        if !rooms.contains(&own) {
            found.push((line, what.to_owned()));
        }
    };
    for (path, line) in paths(tokens) {
        let path: Vec<_> = path.iter().map(String::as_str).collect();
        if touches_files(&path) {
            unless_in(&["io", "bin"], line, "touches files; that is for io");
        }
        match path[0] {
            "wgpu" => unless_in(&["compute", "bin"], line, "names wgpu; that is for compute"),
            "egui" | "eframe" => {
                unless_in(&["bin"], line, "names the window; that is for the binary");
            }
            _ => {}
        }
    }
    for (i, token) in tokens.iter().enumerate() {
        let next = tokens.get(i + 1).map(|next| &next.kind);
        let line = token.line;
        match &token.kind {
            Kind::Word(word) if next == Some(&Kind::Mark("!")) => match word.as_str() {
                "print" | "println" if own == "bin" => unless_in(
                    &[],
                    line,
                    "prints with println!, which panics when its reader leaves; use cli::print",
                ),
                "print" | "println" | "eprint" | "eprintln" | "dbg" => {
                    unless_in(&["bin"], line, "prints; that is for the binary");
                }
                _ => {}
            },
            Kind::Word(word) if next == Some(&Kind::Mark("(")) => match word.as_str() {
                // `io` writes files to it when told to.
                "stdout" | "stderr" => {
                    unless_in(&["io", "bin"], line, "prints; that is for the binary");
                }
                "exists" | "is_file" | "is_dir" | "read_dir" | "canonicalize" | "read_link" => {
                    unless_in(&["io", "bin"], line, "touches files; that is for io");
                }
                _ => {}
            },
            Kind::Text(text) if has_g_word(text) => {
                unless_in(&["gcode", "bin"], line, "writes a G-word; that is for gcode");
            }
            _ => {}
        }
    }
    found
}

fn touches_files(path: &[&str]) -> bool {
    let file_calls = ["open", "create", "create_new", "options"];
    path.starts_with(&["std", "fs"])
        || path[0] == "fs" && 1 < path.len()
        || path[0] == "tempfile"
        || path.contains(&"OpenOptions")
        || path.windows(2).any(|pair| pair[0] == "File" && file_calls.contains(&pair[1]))
}

/// True if `text` has a word such as `G1`, `g93` or `G38.2`; numbers before it do not hide it.
fn has_g_word(text: &str) -> bool {
    let bytes = text.as_bytes();
    (0..bytes.len()).filter(|&i| bytes[i].eq_ignore_ascii_case(&b'g')).any(|i| {
        let n_digits = bytes[i + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let after = bytes.get(i + 1 + n_digits);
        let begins = i == 0 || !(bytes[i - 1].is_ascii_alphabetic() || bytes[i - 1] == b'_');
        let ends = after.is_none_or(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_');
        (1..=3).contains(&n_digits) && begins && ends
    })
}

fn sources_under(folder: &Path, root: &Path) -> Vec<(String, String)> {
    let mut sources = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources.extend(sources_under(&path, root));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
            sources.push((name, fs::read_to_string(&path).unwrap()));
        }
    }
    sources.sort();
    sources
}

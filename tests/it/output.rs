//! Outputs appear whole or not at all.

use horma::io::{OutputSet, Overwrite, WriteError, write_file};
use horma::progress::Cancelled;
use std::fs;
use std::io;
use std::path::Path;

#[test]
fn a_new_file_has_the_mode_of_any_new_file() {
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
    write_file(&ours, Overwrite::Refuse, |out| out.write_all(b"G0")).unwrap();
    fs::write(&plain, "G0").unwrap();
    assert_eq!(fs::read(&ours).unwrap(), b"G0");
    assert_eq!(
        fs::metadata(&ours).unwrap().permissions(),
        fs::metadata(&plain).unwrap().permissions()
    );
}

#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_its_mode() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.ngc");
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    write_file(&path, Overwrite::Replace, |out| out.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link_and_its_target_is_written() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("far")).unwrap();
    for (target, old) in [("far/there.ngc", Some("old")), ("far/not_yet.ngc", None)] {
        let link = folder.path().join("link.ngc");
        symlink(target, &link).unwrap();
        if let Some(old) = old {
            fs::write(folder.path().join(target), old).unwrap();
        }
        write_file(&link, Overwrite::Replace, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(folder.path().join(target)).unwrap(), b"new");
        fs::remove_file(&link).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn links_that_go_in_circles_are_refused() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    symlink("b", folder.path().join("a")).unwrap();
    symlink("a", folder.path().join("b")).unwrap();
    let error = write_file(&folder.path().join("a"), Overwrite::Replace, |_| Ok(())).unwrap_err();
    assert!(matches!(error, WriteError::System { .. }), "{error}");
}

#[test]
fn a_file_that_is_there_is_left_alone_unless_it_may_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.ngc");
    fs::write(&path, "old").unwrap();
    let error = write_file(&path, Overwrite::Refuse, |out| out.write_all(b"new")).unwrap_err();
    assert!(
        error.to_string().ends_with(
            "out.ngc\" exists already; choose another name or overwrite it with --force"
        )
    );
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn a_file_that_appears_meanwhile_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.ngc");
    let error = write_file(&path, Overwrite::Refuse, |_| fs::write(&path, "theirs")).unwrap_err();
    assert!(matches!(error, WriteError::Exists { .. }), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"theirs");
    assert_eq!(names_in(folder.path()), ["out.ngc"]);
}

#[test]
fn a_folder_is_not_a_file_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let error = write_file(folder.path(), Overwrite::Replace, |_| Ok(())).unwrap_err();
    assert!(error.to_string().ends_with("it is a folder; name a file in it"), "{error}");
}

#[test]
fn a_folder_that_does_not_exist_is_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    for missing in ["missing", "file"] {
        let path = folder.path().join(missing).join("out.ngc");
        let error = write_file(&path, Overwrite::Refuse, |_| Ok(())).unwrap_err().to_string();
        let folder = folder.path().join(missing);
        assert!(
            error.contains(&format!("the folder {folder:?} does not exist; create")),
            "{error}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_with_what_to_do() {
    let full = Path::new("/dev/full");
    let error = write_file(full, Overwrite::Refuse, |out| out.write_all(&vec![0; 1 << 20]));
    assert_eq!(
        error.unwrap_err().to_string(),
        "cannot write \"/dev/full\": No space left on device (os error 28); \
         make room or write somewhere else"
    );
    assert!(!fs::metadata(full).unwrap().is_file());
}

#[test]
fn a_write_that_fails_half_way_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    for (name, old) in [("out.ngc", Some("old")), ("new.ngc", None)] {
        let path = folder.path().join(name);
        if let Some(old) = old {
            fs::write(&path, old).unwrap();
        }
        let error = write_file(&path, Overwrite::Replace, |out| {
            out.write_all(&vec![b'x'; 1 << 20])?;
            Err(io::ErrorKind::StorageFull.into())
        });
        let told = error.unwrap_err().to_string();
        assert!(told.ends_with("no storage space; make room or write somewhere else"), "{told}");
    }
    assert_eq!(fs::read(folder.path().join("out.ngc")).unwrap(), b"old");
    assert_eq!(names_in(folder.path()), ["out.ngc"]);
}

#[test]
fn a_request_to_stop_comes_back_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.ngc");
    let stopped = write_file(&path, Overwrite::Refuse, |out| {
        out.write_all(b"half")?;
        Err(io::Error::other(Cancelled))
    });
    assert!(matches!(stopped, Err(WriteError::Cancelled(_))));
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn files_of_a_set_appear_together() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = OutputSet::new(Overwrite::Refuse);
    for name in ["out.ngc", "out.report.html", "out.report.json"] {
        set.add(&folder.path().join(name), |out| out.write_all(name.as_bytes())).unwrap();
        assert!(names_in(folder.path()).iter().all(|found| found.starts_with(".horma-")));
    }
    set.commit().unwrap();
    assert_eq!(names_in(folder.path()), ["out.ngc", "out.report.html", "out.report.json"]);
}

#[test]
fn a_set_that_is_dropped_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = OutputSet::new(Overwrite::Refuse);
    set.add(&folder.path().join("out.ngc"), |out| out.write_all(b"G0")).unwrap();
    assert_eq!(names_in(folder.path()).len(), 1);
    drop(set);
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn a_set_that_fails_at_its_last_rename_takes_the_others_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("old.ngc"), "old").unwrap();
    let mut set = OutputSet::new(Overwrite::Replace);
    for name in ["old.ngc", "new.json", "last.html"] {
        set.add(&at(name), |out| out.write_all(b"new")).unwrap();
    }
    fs::create_dir(at("last.html")).unwrap();
    let error = set.commit().unwrap_err().to_string();
    assert!(error.starts_with(&format!("cannot write {:?}: ", at("last.html"))), "{error}");
    assert_eq!(fs::read(at("old.ngc")).unwrap(), b"old");
    assert_eq!(names_in(folder.path()), ["last.html", "old.ngc"]);
}

#[test]
fn a_set_may_replace_every_file_it_finds() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = OutputSet::new(Overwrite::Replace);
    for name in ["a", "b"] {
        fs::write(folder.path().join(name), "old").unwrap();
        set.add(&folder.path().join(name), |out| out.write_all(b"new")).unwrap();
    }
    set.commit().unwrap();
    for name in ["a", "b"] {
        assert_eq!(fs::read(folder.path().join(name)).unwrap(), b"new");
    }
    assert_eq!(names_in(folder.path()), ["a", "b"]);
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

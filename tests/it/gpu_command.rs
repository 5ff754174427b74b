//! `horma devices`, and `horma cam` on a device, as a user calls them.

use crate::cam_command::{Shop, refused, said};
use crate::command::horma;
use crate::gpu::device;
use serde_json::Value;

/// What the report says of where contacts were found.
fn computed(shop: &Shop) -> Value {
    let report: Value = serde_json::from_slice(&shop.bytes("out.report.json")).unwrap();
    report["run"]["compute"].clone()
}

#[test]
fn a_program_is_the_same_whatever_computed_it_and_the_report_says_what_did() {
    let Some(gpu) = device() else { return };
    let shop = Shop::new();
    let told = shop.cam(&["--compute", "cpu"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    assert_eq!(computed(&shop)["on"], "cpu");
    let expected = shop.bytes("out.ngc");
    let told = shop.cam(&["--force", "--compute", "gpu", "--adapter", gpu.name()]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    assert_eq!(computed(&shop)["on"], gpu.name());
    assert!(String::from_utf8_lossy(&told.stdout).contains(&format!("on {}", gpu.name())));
    assert!(expected == shop.bytes("out.ngc"), "the programs differ");
    let told = shop.cam(&["--force", "--compute", "auto"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let why = computed(&shop)["why"].as_str().unwrap().to_owned();
    assert!(why.contains("a position on the cpu") && why.contains(gpu.name()), "{why}");
    assert!(expected == shop.bytes("out.ngc"), "the programs differ");
}

#[test]
fn a_device_that_is_not_there_is_refused_with_those_that_are() {
    let Some(gpu) = device() else { return };
    let shop = Shop::new();
    let told = shop.cam(&["--compute", "gpu", "--adapter", "no such device"]);
    refused(&told, 65, &["no such device", gpu.name()]);
    assert!(shop.outputs().is_empty());
}

#[test]
fn devices_are_listed_for_people_and_for_programs() {
    let listed = horma(&["devices", "--json"]);
    let listed: Value = serde_json::from_slice(&listed.stdout).unwrap();
    let told = String::from_utf8(horma(&["devices"]).stdout).unwrap();
    for device in listed.as_array().unwrap() {
        assert!(told.contains(device["name"].as_str().unwrap()), "{told}");
        assert!(0 < device["limits"]["binding-bytes"].as_u64().unwrap());
    }
    assert_eq!(listed.as_array().unwrap().is_empty(), told.contains("no Vulkan adapter"));
}

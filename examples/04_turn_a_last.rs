//! The whole walk as a library: a last is drawn, laid on a lathe, digitized and turned into a
//! program that was read back, and a page that shows it.
//!
//! ```sh
//! cargo run --release --example 04_turn_a_last -- last.ngc last.html
//! ```

use horma::gcode::Dialect;
use horma::geom::{Surface, shapes};
use horma::io::report::{cam_page, cam_summary, html};
use horma::io::{OutputSet, Overwrite, read_machine, read_tools};
use horma::progress::Silent;
use horma::workflow::cam::{CamOptions, Job, plan};
use std::path::Path;

fn main() -> anyhow::Result<()> {
    let parameters = shapes::LastParameters { length: 270.0, ..Default::default() };
    let machine = read_machine("last-lathe")?;
    let job = Job {
        name: "a last of 270 mm".into(),
        surface: Surface::Mesh(shapes::last(&parameters)?),
        notes: Vec::new(),
        machine: &machine,
        tool: read_tools(None)?.find("wheel:60,10")?,
        dialect: &Dialect::named(&machine.dialect)?,
        options: &CamOptions { scallop: Some(0.05), allowance: Some(0.5), ..Default::default() },
        keep_scene: true,
    };
    let planned = plan(job, &Silent)?;
    print!("{}", cam_summary(&planned.report));

    // Both files appear, or neither does.
    let mut files = OutputSet::new(Overwrite::Replace);
    let mut names = std::env::args().skip(1);
    if let Some(program) = names.next() {
        files.add(Path::new(&program), |out| out.write_all(&planned.text))?;
    }
    if let Some(page) = names.next() {
        let text = html(&cam_page(&planned.report, planned.scene.as_ref())?);
        files.add(Path::new(&page), |out| out.write_all(text.as_bytes()))?;
    }
    Ok(files.commit()?)
}

//! `horma demo`: the whole job on a last of our own, without any file.

use super::cam::Outputs;
use super::{Shell, verify as verify_command};
use anyhow::Context;
use clap::Args;
use horma::cam::{Block, Centre};
use horma::gcode;
use horma::geom::Surface;
use horma::geom::shapes::{LastParameters, last};
use horma::io::report::{cam_summary, verify_summary};
use horma::io::{self, Overwrite};
use horma::workflow::cam::{CamOptions, CamReport, Job, plan, rough};
use horma::workflow::verify::{RawBlock, VerifyJob, VerifyOptions, VerifyReport, verify};
use serde::Serialize;
use std::path::PathBuf;

/// The machine of the demonstration.
const MACHINE: &str = "last-lathe";
/// What roughing takes at once [mm].
const DEPTH: f64 = 8.0;
/// What it leaves for finishing, ridges included [mm].
const LEFT: f64 = 1.5;
/// How finely the last is cut in simulation [mm].
const RESOLUTION: f64 = 0.5;

/// Make a last and the program that cuts it: no files needed.
#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// The folder to write to; made if it is not there.
    #[arg(long, value_name = "DIR", default_value = "horma-demo")]
    out: PathBuf,
    /// Replace what an earlier demo wrote.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    last: LastParameters,
}

/// All the demonstration has to tell.
#[derive(Debug, Serialize)]
struct DemoReport<'a> {
    rough: &'a CamReport,
    finish: &'a CamReport,
    verified: &'a VerifyReport,
}

/// Makes the last, roughs and finishes it, cuts it in simulation, and says what to do next.
pub(crate) fn run(args: &DemoArgs, shell: &Shell) -> anyhow::Result<()> {
    let mesh = Surface::Mesh(last(&args.last)?);
    io::create_folder(&args.out)?;
    let part = args.out.join("last.stl");
    let [rough_outputs, outputs] =
        ["rough.ngc", "last.ngc"].map(|name| Outputs::checked(&args.out.join(name), args.force));
    let (rough_outputs, outputs) = (rough_outputs?, outputs?);
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    let pages = verify_command::checked_outputs(&args.out.join("last.verify.html"), overwrite)?;
    let machine = io::read_machine(MACHINE)?;
    let dialect = io::read_dialect(&machine.dialect)?;
    let tool = io::read_tools(None)?.find(&machine.default_tool)?;
    // Dogs hold a last at the middles of its ends.
    let options =
        CamOptions { centre: Some(Centre::Ends), stock: Some(LEFT), ..CamOptions::default() };
    let job = || Job {
        name: "last.stl".into(),
        surface: mesh.clone(),
        notes: vec![format!("made by horma: a last of {} mm", args.last.length)],
        machine: &machine,
        tool: tool.clone(),
        dialect: &dialect,
        options: &options,
        keep_scene: true,
    };
    let bar = shell.progress();
    let bar_of_wood = Block::Cylinder { radius: None };
    let for_roughing = CamOptions { max_depth: Some(DEPTH), ..options.clone() };
    let roughed = rough(Job { options: &for_roughing, ..job() }, &bar_of_wood, &bar)
        .context("while roughing the demonstration's last")?;
    let planned = plan(job(), &bar).context("while cutting the demonstration's last")?;
    let verified = verify(
        VerifyJob {
            program_name: "last.ngc".into(),
            program: &gcode::read(&mut planned.text.as_slice(), &machine, &dialect)?,
            part_name: "last.stl".into(),
            surface: mesh.clone(),
            notes: vec!["cut from what roughing leaves".into()],
            machine: &machine,
            tools: vec![tool.clone()],
            setup: &options,
            block: RawBlock::Grown(LEFT),
            options: &VerifyOptions { resolution: Some(RESOLUTION), ..VerifyOptions::default() },
        },
        &bar,
    )
    .context("while cutting the demonstration's last in simulation")?;
    io::write_surface(&part, &mesh, overwrite)?;
    rough_outputs.write(&roughed)?;
    outputs.write(&planned)?;
    verify_command::write(&verified, &pages, overwrite)?;
    drop(bar);
    let (part, folder, page) = (part.display(), args.out.display(), pages[0].display());
    let text = format!(
        "{}\n{}\nwrote {part}\n      {folder}/rough.ngc, from a bar to 1 mm on the last\n{}\n      \
         open {page}: the last as the programs cut it\n      \
         horma cam {part} -m {MACHINE} --mirror --scallop 0.03 -o right.ngc\n      \
         horma cam YOUR-PART.stl -m {MACHINE} -o your-part.ngc",
        cam_summary(&planned.report),
        verify_summary(&verified.report),
        outputs.in_words(&machine, &planned),
    );
    let (rough, finish, verified) = (&roughed.report, &planned.report, &verified.report);
    shell.report(&DemoReport { rough, finish, verified }, &text)
}

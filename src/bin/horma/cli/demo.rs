//! `horma demo`: the whole job on a last of our own, without any file.

use super::Shell;
use super::cam::Outputs;
use super::simulated::{Cutting, Told, Trial};
use super::table::listed;
use anyhow::{Context, bail};
use clap::Args;
use horma::cam::{Block, Centre};
use horma::geom::Surface;
use horma::geom::shapes::{LastParameters, last};
use horma::io::report::cam_summary;
use horma::io::{self, OutputSet, Overwrite};
use horma::workflow::cam::{CamOptions, Job, plan, rough};
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
    rough: Told<'a>,
    finish: Told<'a>,
}

/// Makes the last, roughs and finishes it, cuts it in simulation from the bar on, and says what to do
/// next.
pub(crate) fn run(args: &DemoArgs, shell: &Shell) -> anyhow::Result<()> {
    let mesh = Surface::Mesh(last(&args.last)?);
    io::create_folder(&args.out)?;
    let part = args.out.join("last.stl");
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    let mut files = OutputSet::new(overwrite);
    files.add_surface(&part, &mesh)?;
    let checked = |name| Outputs::checked(&args.out.join(name), overwrite);
    let (rough_outputs, outputs) = (checked("rough.ngc")?, checked("last.ngc")?);
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
    let cutting = Cutting {
        surface: mesh.clone(),
        machine: &machine,
        dialect: &dialect,
        options: &options,
        resolution: RESOLUTION,
    };
    let trial = |name: &str, plan| Trial { name: name.to_owned(), plan, tools: vec![tool.clone()] };
    let trials = vec![trial("rough.ngc", &roughed), trial("last.ngc", &planned)];
    let tried = cutting.run(trials, Some(&bar_of_wood), &bar)?;
    let [rough_cut, cut] = &tried[..] else { bail!("two programs were cut") };
    rough_outputs.add_to(&mut files, &roughed, Some(rough_cut))?;
    outputs.add_to(&mut files, &planned, Some(cut))?;
    bar.stop_if_asked()?;
    files.commit()?;
    drop(bar);
    let finish = Told::new(&planned, Some(cut));
    let part = part.display();
    let mut written = vec![part.to_string()];
    written.extend(rough_outputs.told(&roughed));
    written.extend(outputs.told(&planned));
    let next = [
        format!("horma check {} -m {MACHINE}", outputs.first(&planned)),
        format!("horma cam {part} -m {MACHINE} --mirror --scallop 0.03 -o right.ngc"),
        format!("horma cam YOUR-PART.stl -m {MACHINE} -o your-part.ngc"),
    ];
    let text = format!(
        "{}{}\n{}\n{}",
        cam_summary(&planned.report),
        finish.in_words(),
        listed("wrote", &written),
        listed("next", &next),
    );
    let rough = Told::new(&roughed, Some(rough_cut));
    shell.report(&DemoReport { rough, finish }, &text)
}

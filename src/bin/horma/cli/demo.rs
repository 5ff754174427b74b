//! `horma demo`: the whole job on a last of our own, without any file.

use super::Shell;
use super::cam::Outputs;
use anyhow::Context;
use clap::Args;
use horma::cam::Centre;
use horma::geom::Surface;
use horma::geom::shapes::{LastParameters, last};
use horma::io::report::cam_summary;
use horma::io::{self, Overwrite};
use horma::workflow::cam::{CamOptions, Job, plan};
use std::path::PathBuf;

/// The machine of the demonstration.
const MACHINE: &str = "last-lathe";

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

/// Makes the last, cuts it, and says what to do next.
pub(crate) fn run(args: &DemoArgs, shell: &Shell) -> anyhow::Result<()> {
    let mesh = Surface::Mesh(last(&args.last)?);
    io::create_folder(&args.out)?;
    let part = args.out.join("last.stl");
    let outputs = Outputs::checked(&args.out.join("last.ngc"), args.force)?;
    let machine = io::read_machine(MACHINE)?;
    // Dogs hold a last at the middles of its ends.
    let options = CamOptions { centre: Some(Centre::Ends), ..CamOptions::default() };
    let bar = shell.progress();
    let planned = plan(
        Job {
            name: "last.stl".into(),
            surface: mesh.clone(),
            notes: vec![format!("made by horma: a last of {} mm", args.last.length)],
            machine: &machine,
            tool: io::read_tools(None)?.find(&machine.default_tool)?,
            dialect: &io::read_dialect(&machine.dialect)?,
            options: &options,
            keep_scene: true,
        },
        &bar,
    )
    .context("while cutting the demonstration's last")?;
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    io::write_surface(&part, &mesh, overwrite)?;
    outputs.write(&planned)?;
    drop(bar);
    let part = part.display();
    let text = format!(
        "{}\nwrote {part}\n{}\n      horma cam {part} -m {MACHINE} --mirror --scallop 0.03 -o right.ngc\n      \
         horma cam YOUR-PART.stl -m {MACHINE} -o your-part.ngc",
        cam_summary(&planned.report),
        outputs.in_words(&machine, &planned),
    );
    shell.report(&planned.report, &text)
}

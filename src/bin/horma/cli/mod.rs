//! The command line: one file per subcommand, each with its arguments and a `run`.

mod block;
mod cam;
mod check;
mod convert;
mod demo;
mod devices;
mod dialect;
mod evaluate;
mod fuse;
mod info;
mod last;
mod machine;
mod mean_error;
mod mesh;
mod reduce;
mod register;
mod restart;
mod rough;
mod scan;
mod scan_model;
mod shell;
mod simulate_scan;
mod simulated;
mod table;
mod tool;
mod turntable;
mod verify;

pub(crate) use shell::{Shell, print};

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell as CompletionShell;

/// From a scanned part to a lathe program.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    propagate_version = true,
    arg_required_else_help = true,
    before_help = START_HERE,
    after_help = EXIT_CODES
)]
pub(crate) struct Cli {
    #[command(flatten)]
    shell: Shell,
    #[command(subcommand)]
    command: Command,
}

const START_HERE: &str = "Start here:
  horma demo                                      make a last and the program that cuts it
  horma cam part.stl -m last-lathe -o part.ngc    the same for a part of yours";

const EXIT_CODES: &str = "Exit codes:
  0   done
  2   the command line is wrong
  65  an input is wrong; the message names it
  70  a bug in horma
  73  an output cannot be written
  75  stopped before the end; try again";

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::DemoArgs),
    Cam(Box<cam::CamArgs>),
    Rough(Box<rough::RoughArgs>),
    /// Say what a part file holds: format, units, size, and whether its surface is whole.
    Info(info::InfoArgs),
    /// Convert a part from one format to another.
    Convert(convert::ConvertArgs),
    Last(last::LastArgs),
    Machine(machine::MachineArgs),
    Tool(tool::ToolArgs),
    Dialect(dialect::DialectArgs),
    Check(check::CheckArgs),
    Verify(Box<verify::VerifyArgs>),
    Restart(restart::RestartArgs),
    SimulateScan(Box<simulate_scan::SimulateScanArgs>),
    Evaluate(evaluate::EvaluateArgs),
    Register(Box<register::RegisterArgs>),
    Scan(Box<scan::ScanArgs>),
    Mesh(Box<mesh::MeshArgs>),
    Reduce(Box<reduce::ReduceArgs>),
    MeanError(mean_error::MeanErrorArgs),
    Fuse(Box<fuse::FuseArgs>),
    Devices(devices::DevicesArgs),
    /// Print shell completions.
    #[command(
        after_help = "For example: horma completions bash > ~/.local/share/bash-completion/completions/horma"
    )]
    Completions {
        /// The shell to complete in.
        shell: CompletionShell,
    },
}

impl Cli {
    /// Runs the chosen subcommand.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        self.shell.start_threads()?;
        match &self.command {
            Command::Demo(args) => demo::run(args, &self.shell),
            Command::Cam(args) => cam::run(args, &self.shell),
            Command::Rough(args) => rough::run(args, &self.shell),
            Command::Dialect(args) => dialect::run(args, &self.shell),
            Command::Check(args) => check::run(args, &self.shell),
            Command::Verify(args) => verify::run(args, &self.shell),
            Command::Restart(args) => restart::run(args, &self.shell),
            Command::SimulateScan(args) => simulate_scan::run(args, &self.shell),
            Command::Evaluate(args) => evaluate::run(args, &self.shell),
            Command::Scan(args) => scan::run(args, &self.shell),
            Command::Mesh(args) => mesh::run(args, &self.shell),
            Command::Register(args) => register::run(args, &self.shell),
            Command::Reduce(args) => reduce::run(args, &self.shell),
            Command::MeanError(args) => mean_error::run(args, &self.shell),
            Command::Fuse(args) => fuse::run(args, &self.shell),
            Command::Info(args) => info::run(args, &self.shell),
            Command::Convert(args) => convert::run(args, &self.shell),
            Command::Last(args) => last::run(args, &self.shell),
            Command::Machine(args) => machine::run(args, &self.shell),
            Command::Tool(args) => tool::run(args, &self.shell),
            Command::Devices(args) => devices::run(args, &self.shell),
            Command::Completions { shell } => completions(*shell),
        }
    }
}

fn completions(shell: CompletionShell) -> anyhow::Result<()> {
    // Made in memory first: clap_complete panics on a stdout that fails.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "horma", &mut script);
    print(&String::from_utf8(script)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}

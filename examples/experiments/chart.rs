//! What an experiment leaves: a table in the terminal, the same as CSV, and a chart.

use anyhow::Context as _;
use horma::io::report::{Labels, Series, log_log_chart, sheet};
use horma::io::{OutputSet, Overwrite};
use std::path::Path;

/// A number of each contender over some quantity.
pub(crate) struct Chart {
    /// What they are measured over, with its unit.
    over: String,
    /// What is measured, with its unit.
    what: &'static str,
    /// Of the contenders.
    names: Vec<String>,
    /// The quantity, and the number of each contender.
    rows: Vec<(f64, Vec<f64>)>,
}

impl Chart {
    /// Of seconds.
    pub(crate) fn of_times(over: &str, names: Vec<String>, rows: Vec<(f64, Vec<f64>)>) -> Self {
        let millis =
            |(at, seconds): (f64, Vec<f64>)| (at, seconds.iter().map(|s| s * 1e3).collect());
        let rows = rows.into_iter().map(millis).collect();
        Self { over: over.into(), what: "time [ms]", names, rows }
    }

    /// Of mean errors [mm].
    pub(crate) fn of_errors(over: &str, names: Vec<String>, rows: Vec<(f64, Vec<f64>)>) -> Self {
        Self { over: over.into(), what: "mean error [mm]", names, rows }
    }

    /// Of speed-ups.
    pub(crate) fn of_gains(over: &str, names: Vec<String>, rows: Vec<(f64, Vec<f64>)>) -> Self {
        Self { over: over.into(), what: "speed-up", names, rows }
    }

    /// A row for each value of the quantity, as Markdown.
    pub(crate) fn table(&self) -> String {
        let mut lines = vec![
            self.what.to_owned(),
            String::new(),
            row(&self.over, self.names.iter().cloned()),
            row("---", self.names.iter().map(|_| "---".to_owned())),
        ];
        lines.extend(self.rows.iter().map(|(at, numbers)| {
            row(&at.to_string(), numbers.iter().map(|&number| three_digits(number)))
        }));
        lines.join("\n")
    }

    /// How many times less time `name` takes than `than`, least and most over all rows; nothing if
    /// one of them did not run.
    pub(crate) fn gain(&self, name: &str, than: &str) -> Option<String> {
        let column = |wanted: &str| self.names.iter().position(|name| name == wanted);
        let (name, than) = (column(name)?, column(than)?);
        let gains = self.rows.iter().map(|(_, numbers)| numbers[than] / numbers[name]);
        let least = gains.clone().fold(f64::INFINITY, f64::min);
        let most = gains.fold(0.0, f64::max);
        Some(format!("{} to {}x", three_digits(least), three_digits(most)))
    }

    /// Writes `NAME.csv` and `NAME.svg` into `folder`, both or neither.
    pub(crate) fn write(&self, folder: &Path, name: &str) -> anyhow::Result<()> {
        let series = |(i, name): (usize, &String)| Series {
            name: name.clone(),
            points: self.rows.iter().map(|(at, numbers)| [*at, numbers[i]]).collect(),
        };
        let series: Vec<_> = self.names.iter().enumerate().map(series).collect();
        let svg = sheet(&[log_log_chart(&series, Labels { x: &self.over, y: self.what })]);
        let mut csv = vec![format!("{},{}", self.over, self.names.join(","))];
        csv.extend(self.rows.iter().map(|(at, numbers)| {
            let cells: Vec<_> = numbers.iter().map(|number| format!("{number:.4}")).collect();
            format!("{at},{}", cells.join(","))
        }));
        let csv = csv.join("\n") + "\n";
        std::fs::create_dir_all(folder)
            .with_context(|| format!("making the folder {}", folder.display()))?;
        let paths = ["csv", "svg"].map(|kind| folder.join(format!("{name}.{kind}")));
        let mut files = OutputSet::new(Overwrite::Replace);
        files.add(&paths[0], |out| out.write_all(csv.as_bytes()))?;
        files.add(&paths[1], |out| out.write_all(svg.as_bytes()))?;
        files.commit()?;
        println!("written: {}, {}", paths[0].display(), paths[1].display());
        Ok(())
    }
}

/// A row of a Markdown table.
pub(crate) fn row(first: &str, others: impl Iterator<Item = String>) -> String {
    let others: Vec<_> = others.collect();
    format!("| {first} | {} |", others.join(" | "))
}

fn three_digits(number: f64) -> String {
    let decimals = (2.0 - number.max(1e-3).log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{number:.decimals$}")
}

//! `check`: diagnostics, then the statistics of every signal, then what an audit measures.

use crate::load;
use crate::mistake::Mistake;
use crate::report::Report;
use clap::Args;
use mipless::{Audit, Options, Remedy, Texture};
use mipless_graph::CheckOptions;
use serde_json::{Value, json};
use std::fmt;
use std::path::{Path, PathBuf};

/// The arguments of `check`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Graphs, JSON files; `-` is standard input
    #[arg(value_name = "GRAPH", required = true)]
    graphs: Vec<PathBuf>,
    /// Print the measured errors of every output, by the size of a pixel
    #[arg(long)]
    measure: bool,
}

/// Checks every graph.
#[expect(clippy::unnecessary_wraps, reason = "the verbs share a signature")]
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let several = arguments.graphs.len() > 1;
    let (mut signals, mut audits) = (Vec::new(), Vec::new());
    for path in &arguments.graphs {
        let texture = match load::load(path, &CheckOptions::default(), report) {
            Ok(texture) => texture,
            Err(mistake) => {
                report.mistake(&mistake);
                continue;
            }
        };
        if several {
            report.print(format_args!("{}\n", path.display()));
        }
        let audit = texture.audit(&Options::default());
        if report.is_json() {
            if let Value::Array(mut found) = texture.checked().signals_json() {
                for signal in found.iter_mut().filter_map(Value::as_object_mut) {
                    signal.insert("file".to_owned(), path.display().to_string().into());
                }
                signals.extend(found);
            }
            audits.push(audit_json(path, &texture, &audit, arguments.measure));
        } else {
            report.print(texture.checked().report());
            report.print(Replacements(&texture, &audit));
            if arguments.measure {
                report.print(Measured(&texture, &audit));
            }
        }
    }
    report.result("signals", signals);
    report.result("audits", audits);
    Ok(())
}

/// What of a graph is not closed, and why.
struct Replacements<'a>(&'a Texture, &'a Audit);

impl fmt::Display for Replacements<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(texture, audit) = self;
        if audit.is_too_large {
            writeln!(
                f,
                "the graph has too many nodes for an audit of its closed forms"
            )?;
        }
        if audit.replaced.is_empty() {
            return Ok(());
        }
        writeln!(f, "where the closed form is wrong, `auto` does otherwise:")?;
        for replaced in &audit.replaced {
            let node = texture.checked().graph().node(replaced.node);
            let how = match replaced.remedy {
                Remedy::Sampled => "is averaged over 7 to 32 points inside the footprint",
                Remedy::Repeated => "repeats, and is read from a map of its period",
                Remedy::Drawn => "is drawn to the mean of the texture",
            };
            write!(f, "  {} ({}) {how}", node.name, node.spec.name)?;
            match replaced.sizes {
                [0.0, f32::INFINITY] => writeln!(f)?,
                [0.0, high] => writeln!(f, ", where a pixel is below {high} uv")?,
                [low, f32::INFINITY] => writeln!(f, ", where a pixel is above {low} uv")?,
                [low, high] => writeln!(f, ", where a pixel is {low} to {high} uv")?,
            }
        }
        for audited in &audit.outputs {
            let name = &texture.outputs()[audited.output].name;
            let worst = (audited.bands.iter()).max_by(|x, y| x.closed.total_cmp(&y.closed));
            if let Some(band) = worst {
                writeln!(
                    f,
                    "  `{name}` is off by {:.3} (sRGB RMS) where a pixel is {} uv; by its closed form \
                     by {:.3}, unfiltered by {:.3}",
                    band.auto, band.size, band.closed, band.point
                )?;
            }
        }
        Ok(())
    }
}

/// The measured errors, by outputs and bands.
struct Measured<'a>(&'a Texture, &'a Audit);

impl fmt::Display for Measured<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(texture, audit) = self;
        for audited in &audit.outputs {
            let name = &texture.outputs()[audited.output].name;
            writeln!(
                f,
                "{name}: measured sRGB RMS, by the width of a pixel in uv (predicted: at most {:.3})",
                audited.predicted()
            )?;
            writeln!(
                f,
                "  {:>10} {:>8} {:>8} {:>8}",
                "pixel", "point", "closed", "auto"
            )?;
            for band in &audited.bands {
                writeln!(
                    f,
                    "  {:>10.6} {:>8.4} {:>8.4} {:>8.4}",
                    band.size, band.point, band.closed, band.auto
                )?;
            }
        }
        if audit.is_too_large {
            writeln!(f, "the graph has too many nodes to be measured")?;
        } else if audit.outputs.is_empty() {
            writeln!(
                f,
                "every output is a linear combination of Gaussian signals: exact"
            )?;
        }
        Ok(())
    }
}

/// What `audits` holds for a graph.
fn audit_json(path: &Path, texture: &Texture, audit: &Audit, measure: bool) -> Value {
    let replaced = audit.replaced.iter().map(|replaced| {
        let node = texture.checked().graph().node(replaced.node);
        let remedy = match replaced.remedy {
            Remedy::Sampled => "sampled",
            Remedy::Repeated => "repeated",
            Remedy::Drawn => "drawn",
        };
        let [low, high] = replaced.sizes;
        json!({
            "node": node.name,
            "pointer": node.pointer,
            "remedy": remedy,
            "from": low,
            "to": high.is_finite().then_some(high),
        })
    });
    let outputs = audit.outputs.iter().map(|audited| {
        let mut json = json!({
            "output": texture.outputs()[audited.output].name,
            "predicted": audited.predicted(),
        });
        if measure {
            let bands = audited.bands.iter().map(|band| {
                json!({
                    "pixel": band.size,
                    "point": band.point,
                    "closed": band.closed,
                    "auto": band.auto,
                })
            });
            json["measured"] = bands.collect();
        }
        json
    });
    json!({
        "file": path.display().to_string(),
        "too_large": audit.is_too_large,
        "replaced": replaced.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
    })
}

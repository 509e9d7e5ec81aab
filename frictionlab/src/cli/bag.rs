//! `frictionlab bag`: what is in a bag, as a table, and made whole again.

use std::path::{Path, PathBuf};

use recording::bag::{BagError, BagReader, Recovery, recover};
use work::destination::Force;
use work::saying::print;

/// Look into a bag, make a table of it, or save what is left
#[derive(Debug, clap::Args)]
pub struct BagArgs {
    #[command(subcommand)]
    command: BagCommand,
}

#[derive(Debug, clap::Subcommand)]
enum BagCommand {
    /// Record what the running nodes publish, until ctrl-C
    ///
    /// For those without `ros2 bag record`: every topic of one axis, and /diagnostics, as rosbag2
    /// would write them. `frictionlab live` and `frictionlab run` record by themselves.
    #[cfg(feature = "ros")]
    Record {
        /// Folder for the bag, new or empty
        #[arg(value_name = "DIR")]
        bag: PathBuf,
        /// Namespace of the axis, as in axis_1
        #[arg(long, value_name = "NAME")]
        namespace: Option<String>,
        /// Length [s] [default: until ctrl-C]
        #[arg(long, value_name = "SECONDS")]
        duration: Option<f64>,
    },
    /// List the topics of a bag, with types and numbers of messages, and what was kept with it
    Info {
        /// Folder of the bag, or an .mcap file
        #[arg(value_name = "DIR")]
        bag: PathBuf,
        /// Print it as JSON for programs (docs/reference/json.md)
        #[arg(long)]
        json: bool,
    },
    /// Make a bag whole that was cut off by a kill or a full disk, or damaged
    ///
    /// Writes a new MCAP file of everything that is whole, with its index, and metadata.yaml, so
    /// that stock tools open it. The original stays beside it with `.damaged` behind its name. A
    /// bag that is whole stays as it is; one that is being written is refused. A killed run loses
    /// at most its last second.
    Recover {
        /// Folder of the bag
        #[arg(value_name = "DIR")]
        bag: PathBuf,
    },
    /// Write the cycles of a bag as comma-separated values, one line a time stamp
    ///
    /// The columns are those that `frictionlab identify` reads:
    /// t_s,position_rad,velocity_rad_s,voltage_V,torque_Nm, and behind them the reference, the
    /// command and the friction estimate. A field is empty where the bag has no message of that
    /// time.
    ToCsv {
        /// Folder of the bag, or an .mcap file
        #[arg(value_name = "DIR")]
        bag: PathBuf,
        /// The file; - is standard output [default: beside the bag, its name with .csv behind]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
        #[command(flatten)]
        force: Force,
    },
}

/// Runs it.
///
/// # Errors
/// [`BagError`] and [`OutputError`](files::OutputError) name the bag or file at fault.
pub fn execute(args: &BagArgs) -> anyhow::Result<()> {
    let text = match &args.command {
        #[cfg(feature = "ros")]
        BagCommand::Record { bag, namespace, duration } => {
            record(bag, namespace.as_deref(), *duration)?
        }
        BagCommand::Info { bag, json } => info(bag, *json)?,
        BagCommand::Recover { bag } => recovered(bag)?,
        BagCommand::ToCsv { bag, out, force } => to_csv(bag, out.as_deref(), force)?,
    };
    print(&text)
}

#[cfg(feature = "ros")]
fn record(bag: &Path, namespace: Option<&str>, duration: Option<f64>) -> anyhow::Result<String> {
    use recording::record::{RecordOptions, record};
    if let Some(length) = duration.filter(|length| !(*length > 0.0 && length.is_finite())) {
        return Err(work::BadInput(format!("--duration must be above 0 s, but is {length}")).into());
    }
    ros_node::ends_within(ros_node::ENDS_WITHIN_WRITING);
    let stop = ros_node::Stop::on_signals()?;
    let namespace =
        namespace.map(|name| format!("/{}", name.trim_matches('/'))).filter(|name| name != "/");
    let options = RecordOptions { dir: bag.to_owned(), namespace, duration };
    let ready = || _ = print(&format!("recording into {}; ctrl-C ends it\n", bag.display()));
    let recorded = record(&options, &stop, ready)?;
    let lost = match recorded.dropped {
        0 => String::new(),
        lost => format!(", {lost} lost because the disk was too slow"),
    };
    Ok(format!("{} messages in {}{lost}\n", recorded.bag.messages, recorded.bag.dir.display()))
}

fn info(path: &Path, json: bool) -> Result<String, BagError> {
    let bag = BagReader::open(path)?;
    if json {
        return document(path, &bag).map(|document| format!("{document:#}\n"));
    }
    let width = bag.topics().iter().map(|topic| topic.name.len()).max().unwrap_or(0);
    let messages: u64 = bag.topics().iter().map(|topic| topic.count).sum();
    let megabytes = bag.bytes() as f64 * 1e-6;
    let mut text = format!("{}: {messages} messages, {megabytes:.1} MB", path.display());
    if let Some((start, end)) = bag.span() {
        text += &format!(
            ", {:.3} s from {}.{:09} s since 1970",
            end.saturating_sub(start) as f64 * 1e-9,
            start / 1_000_000_000,
            start % 1_000_000_000
        );
    }
    text.push('\n');
    for topic in bag.topics() {
        text += &format!("  {:<width$}  {:<35} {:>10}\n", topic.name, topic.type_name, topic.count);
    }
    for name in bag.attachment_names() {
        text += &format!("  attachment {name}\n");
    }
    for name in bag.metadata_names().filter(|name| *name != "rosbag2") {
        let entries = bag.metadata(name)?.unwrap_or_default();
        for (key, value) in entries {
            let line = value.lines().next().unwrap_or_default();
            let shown: String = line.chars().take(90).collect();
            let more = if shown.len() < value.len() { " ..." } else { "" };
            text += &format!("  {name}: {key} = {shown}{more}\n");
        }
    }
    Ok(text)
}

/// The same for programs.
fn document(path: &Path, bag: &BagReader) -> Result<serde_json::Value, BagError> {
    let topics: Vec<_> = bag
        .topics()
        .iter()
        .map(
            |topic| serde_json::json!({"name": topic.name, "type": topic.type_name, "messages": topic.count}),
        )
        .collect();
    let mut metadata = serde_json::Map::new();
    for name in bag.metadata_names().filter(|name| *name != "rosbag2") {
        let entries = bag.metadata(name)?.unwrap_or_default();
        metadata.insert(name.to_owned(), serde_json::json!(entries));
    }
    let span = bag.span();
    Ok(serde_json::json!({
        "format": "frictionlab-bag",
        "format_version": 1,
        "bag": path.display().to_string(),
        "bytes": bag.bytes(),
        "messages": bag.topics().iter().map(|topic| topic.count).sum::<u64>(),
        "start_ns": span.map(|(start, _)| start),
        "end_ns": span.map(|(_, end)| end),
        "topics": topics,
        "attachments": bag.attachment_names().collect::<Vec<_>>(),
        "metadata": metadata,
    }))
}

fn recovered(path: &Path) -> Result<String, BagError> {
    Ok(match recover(path)? {
        Recovery::Whole => format!("{} is whole; nothing was done\n", path.display()),
        Recovery::Recovered {
            bag,
            original,
            lost_bytes,
            lost_chunks,
            lost_messages,
            mended_definitions,
            lost_definitions,
        } => {
            let mut text = format!(
                "{}: {} messages over {:.3} s are whole; the original is kept as {}\n",
                bag.file.display(),
                bag.messages,
                bag.duration,
                original.display()
            );
            if lost_bytes > 0 {
                text +=
                    &format!("lost: {lost_bytes} bytes, among them {lost_chunks} damaged chunks\n");
            }
            if lost_messages > 0 {
                text +=
                    &format!("lost: {lost_messages} messages whose topic is not known any more\n");
            }
            if !mended_definitions.is_empty() {
                text += &format!(
                    "mended: the damaged definition of the type of {}, by the one that its hash names\n",
                    mended_definitions.join(", ")
                );
            }
            if !lost_definitions.is_empty() {
                text += &format!(
                    "lost: the damaged definition of the type of {}; the messages are kept without one\n",
                    lost_definitions.join(", ")
                );
            }
            text
        }
    })
}

fn to_csv(path: &Path, out: Option<&Path>, force: &Force) -> anyhow::Result<String> {
    let out = force.file(&out.map_or_else(|| path.with_extension("csv"), Path::to_owned))?;
    let table = recording::bag::table(path)?;
    out.write(table.text.as_bytes())?;
    // Standard output has the table and nothing else.
    Ok(if out.is_stdout() {
        String::new()
    } else {
        format!("{}: {} lines\n", out.name(), table.rows)
    })
}

//! What can be wrong with a recording's file.

use std::path::PathBuf;

use files::is_of_the_path;

use crate::column::{Channel, UnitError};

/// Why a file cannot be used as a recording. Each message names the file, the line or column, and
/// the way out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// Two recordings cannot be taken for one.
    #[error("{} and {} cannot be identified together: {why}", first.display(), other.display())]
    NotJoined {
        /// One of them.
        first: PathBuf,
        /// The other.
        other: PathBuf,
        /// What differs, and what helps.
        why: String,
    },
    /// The file cannot be read.
    #[error("{} cannot be read: {source}; check the path and the permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file has nothing in it.
    #[error("{} is empty; expected a header line with column names, then one line a sample", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// There is a header and nothing else.
    #[error("{} has a header but no samples below it; expected one line a sample", path.display())]
    HeaderOnly {
        /// The file.
        path: PathBuf,
    },
    /// The first line holds numbers.
    #[error(
        "line 1 of {} holds numbers where column names were expected; add a header line such as {example}, or give the \
         numbers of its {columns} columns, counted from 1, to the options that name columns",
        path.display()
    )]
    NoHeader {
        /// The file.
        path: PathBuf,
        /// A header that would do.
        example: &'static str,
        /// Columns that it has.
        columns: usize,
    },
    /// A column's unit is not known, or none of what it is to hold.
    #[error("column `{column}` of {}: {source}; or give the factor to SI units behind the name, as NAME:SCALE", path.display())]
    Unit {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// What is wrong with its unit.
        source: UnitError,
    },
    /// No row has all values.
    #[error("{}: {} has no value in any of {rows} rows (empty or NaN); name another column", path.display(), named(column.as_deref()))]
    NoValues {
        /// The file.
        path: PathBuf,
        /// The column without any value; none where each has some.
        column: Option<String>,
        /// Rows.
        rows: usize,
    },
    /// A line is not text, or not as long as the header.
    #[error("line {line} of {} is damaged: {detail}; repair or delete the line", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, the header being 1.
        line: u64,
        /// What is wrong with it.
        detail: String,
    },
    /// A column that was asked for is not there.
    #[error("{} has no column `{name}`; its columns are: {present}; choose one of them", path.display())]
    NoColumn {
        /// The file.
        path: PathBuf,
        /// The column asked for.
        name: String,
        /// The columns there are.
        present: String,
        /// What it was to hold.
        channel: Channel,
    },
    /// No column could be recognised for a channel.
    #[error("{} has no column that is recognised as the {}; its columns are: {present}; name one of them (a unit in its name is then converted), with a scale where its values are not in {}", path.display(), channel.describe(), channel.unit())]
    Unrecognised {
        /// The file.
        path: PathBuf,
        /// What was looked for.
        channel: Channel,
        /// The columns there are.
        present: String,
    },
    /// A column that has to be there is not, under any of its names.
    #[error("{} has no column with the {channel}; expected one named {expected}, but its columns are: {present}", path.display())]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// What was looked for.
        channel: &'static str,
        /// Its usual names.
        expected: &'static str,
        /// The columns there are.
        present: String,
    },
    /// Several columns hold what one must hold.
    #[error("{} has several columns with the {channel}: {present}; keep one of them", path.display())]
    Several {
        /// The file.
        path: PathBuf,
        /// What they hold.
        channel: &'static str,
        /// Their names.
        present: String,
    },
    /// Two columns have the same name.
    #[error("{} has {count} columns named `{name}`: {present}; name one of them so", path.display())]
    Ambiguous {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
        /// How often it is there.
        count: usize,
        /// What they are called in full.
        present: String,
    },
    /// A cell is no finite number.
    #[error("{place} of {}, column `{column}`: expected {expected}, but found `{found}`; repair the cell or cut the recording there", path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// `line 17` of a text, the header being 1, or `row 17`.
        place: String,
        /// The column.
        column: String,
        /// What was expected.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// Times that can hardly be seconds, in a column that does not say its unit.
    #[error("the times in column `{column}` of {} are {step} apart, which no recording of an axis is if they are seconds; expected steps of at most 0.5 s, or a column that says its unit: `{column}:{scale:e}` gives it a factor to seconds, `{column}:1` says that these are seconds", path.display())]
    TimeUnit {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// The usual step, taken as it is written.
        step: f64,
        /// A factor to seconds with which it would be a recording.
        scale: f64,
    },
    /// Time stands still or runs backwards.
    #[error("{place} of {}: time does not increase, {time} s comes after {before} s; expected the samples in the order of time", path.display())]
    TimeOrder {
        /// The file.
        path: PathBuf,
        /// `line 17` or `message 17`.
        place: String,
        /// The time before \[s\].
        before: f64,
        /// The time there \[s\].
        time: f64,
    },
    /// Most samples have the time of the one before.
    #[error(
        "{repeated} of the {samples} times in {} repeat the one before: that clock counts too coarsely, or not at all; \
         expected a time of its own for each sample",
        path.display()
    )]
    CoarseTimes {
        /// The file.
        path: PathBuf,
        /// Samples that have the time of the one before.
        repeated: usize,
        /// All samples.
        samples: usize,
    },
    /// The samples are not evenly spaced.
    #[error("{place} of {}: the time step there is {step} s, but the usual one is {usual} s, and {percent} % more or less is accepted; cut the file there and give one of the parts", path.display())]
    Uneven {
        /// The file.
        path: PathBuf,
        /// `line 17` or `message 17`.
        place: String,
        /// The step \[s\].
        step: f64,
        /// The median step \[s\].
        usual: f64,
        /// Accepted deviation \[%\].
        percent: f64,
    },
    /// There is no usual time step.
    #[error(
        "the samples of {} come at irregular times, mostly {shortest} to {longest} s apart, {usual} s in the middle; \
         bring them to an even rate, as in {rate} Hz",
        path.display()
    )]
    Irregular {
        /// The file.
        path: PathBuf,
        /// One step in twenty is shorter \[s\].
        shortest: f64,
        /// The median step \[s\].
        usual: f64,
        /// One step in twenty is longer \[s\].
        longest: f64,
        /// A rate that would do \[Hz\].
        rate: f64,
    },
    /// The rate to resample to is out of range.
    #[error(
        "{} has {mean_rate} samples a second, which cannot be brought to {rate} Hz; expected at most ten times as many and \
         not fewer than a five hundredth",
        path.display()
    )]
    ResampleRate {
        /// The file.
        path: PathBuf,
        /// The rate asked for \[Hz\].
        rate: f64,
        /// Mean rate of the samples \[Hz\].
        mean_rate: f64,
    },
    /// A file that is no text cannot be read.
    #[error("{} cannot be read as {form}: {detail}; save it anew, {convert}", path.display())]
    Form {
        /// The file.
        path: PathBuf,
        /// What it was taken for.
        form: &'static str,
        /// What is wrong with it.
        detail: String,
        /// How it is saved so that it can be read.
        convert: &'static str,
    },
    /// Arrays in memory are no table.
    #[error("{}: {detail}; give arrays of numbers of one length, a value for each sample", path.display())]
    Arrays {
        /// What they are called.
        path: PathBuf,
        /// What is wrong with them.
        detail: String,
    },
    /// Tables that were to stand beside each other have not as many rows.
    #[error("{} has {rows} rows, but {} has {expected}; tables beside each other must have a row for each sample", path.display(), beside.display())]
    Joined {
        /// The file.
        path: PathBuf,
        /// Its rows.
        rows: usize,
        /// The first of the others.
        beside: PathBuf,
        /// The rows of that one.
        expected: usize,
    },
    /// A motion along a line beside a torque, or a turn beside a force.
    #[error("column `{motion}` of {} and column `{force}` are of two kinds of axis; expected a force of an axis that moves along a line, or a torque of one that turns: `{force}:FACTOR` gives the factor that turns its values into {unit} at that motion", path.display())]
    TwoAxes {
        /// The file.
        path: PathBuf,
        /// The column of the motion.
        motion: String,
        /// The column of the force or torque.
        force: String,
        /// Unit of what would go with the motion.
        unit: &'static str,
    },
    /// A table has a time, and a period was given besides.
    #[error("{} has the time in column `{column}`, and the time from row to row was given besides, {period} s; leave out one of them", path.display())]
    TimeTwice {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// What was given \[s\].
        period: f64,
    },
    /// Not a servo log.
    #[error("{} is no servo log that can be used: {detail}", path.display())]
    ServoLog {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        detail: String,
    },
    /// Too short to have a sampling period.
    #[error("{} has {found} samples, but at least {needed} are needed; record longer", path.display())]
    TooShort {
        /// The file.
        path: PathBuf,
        /// Samples there.
        found: usize,
        /// Samples needed.
        needed: usize,
    },
    /// Its samples cannot be conditioned.
    #[error("{}: {source}", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: friction_ident::IdentError,
    },
    /// A bag's message lacks what is needed.
    #[error("message {index} of {topic} in {}: {detail}", path.display())]
    Message {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The message, counted from 1.
        index: usize,
        /// What is wrong with it.
        detail: String,
    },
    /// The messages of a joint lack what is needed of them.
    #[error(
        "{} of {topic} in {} has no {lacks} that is a number in {without} of {all} messages{}",
        joint.as_ref().map_or_else(|| "the joint".to_owned(), |name| format!("joint {name}")),
        path.display(),
        if *voltage {
            "; this bag holds the rig's voltage, which gives the torque with the constants of its motor"
        } else if *lacks == "effort" {
            ": the bag shows the motion, but not what drives it; many drivers leave the effort empty until they \
             are told to report it. Record it, or write a table with the motor's current or voltage beside the motion"
        } else {
            ": the bag does not show the motion; record the joint's position or velocity too"
        }
    )]
    NoEffort {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The joint, where it has a name.
        joint: Option<String>,
        /// What it lacks.
        lacks: &'static str,
        /// Messages without it.
        without: usize,
        /// All messages.
        all: usize,
        /// The bag holds the voltage of a rig.
        voltage: bool,
    },
    /// A bag holds more joints than one, and none was named.
    #[error("{} holds several joints: {present}; name one of them", path.display())]
    SeveralJoints {
        /// The bag.
        path: PathBuf,
        /// Their names.
        present: String,
    },
    /// A bag holds several joints without names.
    #[error("message {index} of {topic} in {} has {joints} joints and no names; record it with names", path.display())]
    NoJointNames {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The message, counted from 1.
        index: usize,
        /// Joints in it.
        joints: usize,
    },
    /// A message has the same joint twice.
    #[error("message {index} of {topic} in {} has joint `{name}` twice; expected each once", path.display())]
    JointTwice {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The message, counted from 1.
        index: usize,
        /// The joint.
        name: String,
    },
    /// A bag does not hold the joint that was named.
    #[error("{} holds no joint `{name}`; its joints are: {present}", path.display())]
    NoJoint {
        /// The bag.
        path: PathBuf,
        /// The joint asked for.
        name: String,
        /// The joints there are.
        present: String,
    },
    /// A bag that is not of this laboratory does not say what its effort is.
    #[error(
        "{} does not say what the effort of joint {joint} is: the torque that drives the joint, as of most robots, or \
         friction alone; say which",
        path.display()
    )]
    EffortMeaning {
        /// The bag.
        path: PathBuf,
        /// The joint.
        joint: String,
    },
    /// The bag itself cannot be read.
    #[error(transparent)]
    Bag(#[from] crate::bag::BagError),
}

fn named(column: Option<&str>) -> String {
    column.map_or_else(|| "some column".to_owned(), |column| format!("column `{column}`"))
}

impl RecordingError {
    /// Whether whoever gave the file can mend it: a file that the machine fails to read is no such
    /// thing.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Read { source, .. } => is_of_the_path(source),
            Self::Bag(error) => error.is_bad_input(),
            Self::Form { .. }
            | Self::Arrays { .. }
            | Self::Joined { .. }
            | Self::NotJoined { .. }
            | Self::TimeTwice { .. }
            | Self::TwoAxes { .. }
            | Self::CoarseTimes { .. }
            | Self::NoJointNames { .. }
            | Self::JointTwice { .. }
            | Self::Empty { .. }
            | Self::HeaderOnly { .. }
            | Self::NoHeader { .. }
            | Self::Unit { .. }
            | Self::NoValues { .. }
            | Self::TimeUnit { .. }
            | Self::Line { .. }
            | Self::NoColumn { .. }
            | Self::Unrecognised { .. }
            | Self::MissingColumn { .. }
            | Self::Several { .. }
            | Self::Ambiguous { .. }
            | Self::Cell { .. }
            | Self::TimeOrder { .. }
            | Self::Uneven { .. }
            | Self::Irregular { .. }
            | Self::ResampleRate { .. }
            | Self::ServoLog { .. }
            | Self::TooShort { .. }
            | Self::Unusable { .. }
            | Self::Message { .. }
            | Self::SeveralJoints { .. }
            | Self::NoJoint { .. }
            | Self::EffortMeaning { .. }
            | Self::NoEffort { .. } => true,
        }
    }
}

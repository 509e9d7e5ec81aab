//! What every executable does first and last: read its arguments, join, and say why it ends.

use std::{fmt::Display, io::Write, process::ExitCode, sync::Arc};

use crate::{
    Arguments, Discovery, Participant, ROS_ARGUMENTS_HELP, RosNodeError, Stop, ending, launched,
    middleware::{Lost, Watch},
    terminal,
};

/// The code with which a program ends when an argument, a parameter or an environment variable is
/// wrong.
const BAD_INPUT: u8 = 2;

/// Runs a node's program: `about` is what `--help` says of it, `given` are the words behind its
/// name ([`command_line`](crate::command_line)), `body` runs until the wish to end.
///
/// Ends with code 0, with 1 if `body` fails or the middleware computes without end, and with 2 if
/// the command line, a parameter or the environment is wrong.
///
/// Where the middleware dies under the node, as it does when the process was stopped and continued
/// or the machine was suspended, `body` is asked to end, and begins anew on a new participant with
/// the parameters of the command line: a node that hears nothing is of no use, and one that starts
/// is in a state that everybody knows.
pub fn run(
    name: &str,
    version: &str,
    about: &str,
    given: Vec<String>,
    mut body: impl FnMut(&Participant, &Stop) -> Result<(), RosNodeError>,
) -> ExitCode {
    let fail = |text: &dyn Display, code: u8| {
        terminal::tell(format!("{name}: {text}"));
        terminal::flush();
        ExitCode::from(code)
    };
    let arguments = match Arguments::in_process(given) {
        Ok(arguments) => arguments.or_enclave(&format!("/{name}")),
        Err(error) => return fail(&error, BAD_INPUT),
    };
    match arguments.user.first().map(String::as_str) {
        None => {}
        Some("--help" | "-h") => {
            let _ = write!(
                std::io::stdout(),
                "{about}\n\nUsage: {name} [--ros-args ROS ARGUMENTS]\n\n{ROS_ARGUMENTS_HELP}"
            );
            return ExitCode::SUCCESS;
        }
        Some("--version" | "-V") => {
            let _ = writeln!(std::io::stdout(), "{name} {version}");
            return ExitCode::SUCCESS;
        }
        Some(other) => {
            let text = format!(
                "the argument `{other}` is unknown; parameters are given as --ros-args -p NAME:=VALUE, and --help shows the rest"
            );
            return fail(&text, BAD_INPUT);
        }
    }
    let discovery = match Discovery::from_environment() {
        Ok(discovery) => discovery,
        Err(error) => return fail(&error, BAD_INPUT),
    };
    for warning in Discovery::warnings() {
        terminal::tell(format!("{name}: {warning}"));
    }
    terminal::tell_panics();
    let wished = match Stop::on_signals() {
        Ok(wished) => wished,
        Err(error) => return fail(&error, 1),
    };
    if let Err(error) = launched::end_with_launcher() {
        return fail(&format_args!("the end of its launcher cannot be watched for: {error}"), 1);
    }
    let last_phases = Arc::default();
    loop {
        let joined =
            Participant::join_after(&discovery, arguments.clone(), Arc::clone(&last_phases));
        let participant = match joined {
            Ok(participant) => participant,
            Err(error) if error.is_bad_input() => return fail(&error, BAD_INPUT),
            Err(error) => return fail(&error, 1),
        };
        let watch = match Watch::start(&wished) {
            Ok(watch) => watch,
            Err(error) => return fail(&error, 1),
        };
        let ended = body(&participant, watch.stop());
        let lost = watch.end();
        if let Some(lost @ Lost::Stuck(_)) = &lost {
            // Leaving would wait for the stuck thread.
            ending::force(
                1,
                &format!(
                    "{name}: {lost}; the node ends, with the motor at zero volts: start it again"
                ),
            );
        }
        drop(participant);
        match (ended, lost) {
            (Err(error), _) if error.is_bad_input() => return fail(&error, BAD_INPUT),
            (Err(error), None) => return fail(&error, 1),
            (Ok(()), None) => return ExitCode::SUCCESS,
            (_, Some(_)) if wished.is_set() => return ExitCode::SUCCESS,
            (_, Some(lost)) => {
                terminal::tell(format!(
                    "{name}: {lost}; the node starts anew, with the parameters it was started with"
                ));
            }
        }
    }
}

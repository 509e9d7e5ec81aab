//! The reader's scheduling class.

#[cfg(unix)]
use std::os::unix::thread::JoinHandleExt;
use std::thread::JoinHandle;

#[cfg(unix)]
use thread_priority::{
    ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
    thread_schedule_policy_param,
};

/// Gives `reader` the calling thread's real-time class and priority, if the caller has one: what
/// the control thread waits for is then not held up by what it overtakes. Says whether the reader
/// has the caller's class now; an ordinary caller changes nothing.
#[cfg(unix)]
pub(super) fn follow(reader: &JoinHandle<()>) -> bool {
    let Ok((policy, parameters)) = thread_schedule_policy_param(thread_native_id()) else {
        return false;
    };
    if !matches!(policy, ThreadSchedulePolicy::Realtime(_)) {
        return true;
    }
    // On Linux a `pthread_t` is the same type for both.
    let reader = reader.as_pthread_t();
    let priority = ThreadPriority::from_posix(parameters);
    set_thread_priority_and_policy(reader, priority, policy).is_ok()
}

/// On Windows the control thread has no class that could be followed.
#[cfg(windows)]
pub(super) fn follow(_reader: &JoinHandle<()>) -> bool {
    true
}

#[cfg(all(test, unix))]
mod tests {
    use std::sync::mpsc::channel;

    use thread_priority::{RealtimeThreadSchedulePolicy, ThreadPriorityValue};

    use super::*;

    fn class() -> (ThreadSchedulePolicy, i32) {
        let (policy, parameters) = thread_schedule_policy_param(thread_native_id()).unwrap();
        (policy, parameters.sched_priority)
    }

    #[test]
    fn the_reader_gets_the_class_of_the_thread_that_waits_for_it() {
        std::thread::spawn(|| {
            let (ask, asked) = channel::<()>();
            let (tell, told) = channel();
            let reader = std::thread::spawn(move || {
                while asked.recv().is_ok() {
                    tell.send(class()).unwrap()
                }
            });
            assert!(follow(&reader), "an ordinary thread has nothing to follow");
            let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
            let priority = ThreadPriority::Crossplatform(ThreadPriorityValue::try_from(7).unwrap());
            match set_thread_priority_and_policy(thread_native_id(), priority, policy) {
                Ok(()) => assert!(follow(&reader)),
                Err(error) => {
                    println!("no real-time class is granted here ({error:?}): both stay ordinary")
                }
            }
            ask.send(()).unwrap();
            assert_eq!(told.recv().unwrap(), class());
            drop(ask);
            reader.join().unwrap();
        })
        .join()
        .unwrap();
    }
}

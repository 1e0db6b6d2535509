//! Processes that do jobs side by side, and who gets which job: those of one model go to one
//! process, which reads the model once. A process that a job brings down is replaced, and the job
//! counts as failed.

use super::job::{Job, Task};
use super::worker::{Order, Reply};
use crate::program;
use crate::report::Failure;
use std::collections::{BTreeMap, VecDeque};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, mpsc};

/// Exit code of a job whose process ended.
const BROUGHT_DOWN: u8 = 1;

/// How jobs are done.
#[derive(Debug)]
pub(crate) struct Pool<'p> {
    pub(crate) processes: usize,
    /// Threads of each.
    pub(crate) threads: usize,
    pub(crate) record: PathBuf,
    /// Hands out no more jobs once this is set.
    pub(crate) stop: &'p AtomicBool,
}

/// Jobs that wait, by their models.
struct Queue<'j> {
    groups: Vec<VecDeque<(&'j str, &'j Task)>>,
    /// For each group, whether a process is at it.
    taken: Vec<bool>,
}

impl<'j> Queue<'j> {
    fn new(jobs: &[&'j Job]) -> Self {
        // Group the jobs by their models, in the order in which the models come.
        let mut places: BTreeMap<&[String], usize> = BTreeMap::new();
        let mut groups: Vec<VecDeque<_>> = Vec::new();
        for job in jobs {
            let Ok(task) = &job.task else { continue };
            let place = *places.entry(&task.models).or_insert_with(|| {
                groups.push(VecDeque::new());
                groups.len() - 1
            });
            groups[place].push_back((job.id.as_str(), task));
        }

        // Start with no group taken.
        let taken = vec![false; groups.len()];
        Self { groups, taken }
    }

    /// The next job for a process that is at a group: of the same, else of one that nobody is at,
    /// else of the longest.
    fn next(&mut self, at: &mut Option<usize>) -> Option<(&'j str, &'j Task)> {
        // Stay with the group as long as it has jobs.
        if let Some(job) = at.and_then(|at| self.groups[at].pop_front()) {
            return Some(job);
        }

        // Find a group that no process has taken, or else the longest.
        let fresh = (0..self.groups.len()).find(|&group| !self.taken[group]);
        let longest = || (0..self.groups.len()).max_by_key(|&group| self.groups[group].len());
        let group = fresh.or_else(longest)?;

        // Take it and its first job.
        self.taken[group] = true;
        *at = Some(group);
        self.groups[group].pop_front()
    }
}

impl Pool<'_> {
    /// Does all jobs that can be done; `report` is told of each, in the order in which they end.
    pub(crate) fn run(
        &self,
        jobs: &[&Job],
        mut report: impl FnMut(&str, &Task, &Reply),
    ) -> Result<(), Failure> {
        let queue = Mutex::new(Queue::new(jobs));
        let (send, replies) = mpsc::channel();
        std::thread::scope(|scope| {
            // Start a thread for each process, but no more than there are jobs.
            for _ in 0..self.processes.min(jobs.len()) {
                let (send, queue) = (send.clone(), &queue);
                scope.spawn(move || self.serve(queue, &send));
            }

            // Report the replies until the last thread has dropped its sender.
            drop(send);
            for reply in replies {
                let (id, task, reply): (&str, &Task, Result<Reply, Failure>) = reply;
                report(id, task, &reply?);
            }
            Ok(())
        })
    }

    /// Feeds one process with jobs.
    fn serve<'j>(
        &self,
        queue: &Mutex<Queue<'j>>,
        send: &mpsc::Sender<(&'j str, &'j Task, Result<Reply, Failure>)>,
    ) {
        let (mut at, mut process) = (None, None);
        while !self.stop.load(Ordering::Relaxed) {
            // Take the next job, and have it done.
            let next = queue.lock().expect("no thread panics while it takes a job").next(&mut at);
            let Some((id, task)) = next else { break };
            let reply = self.ask(&mut process, id, task);
            let is_over = reply.is_err();
            if self.stop.load(Ordering::Relaxed) && process.is_none() {
                // The interruption ended it, not the job.
                break;
            }

            // Send the reply; end if nobody receives it, or if no process can be started.
            if send.send((id, task, reply)).is_err() || is_over {
                break;
            }
        }

        // End the process.
        process.into_iter().for_each(Process::end);
    }

    /// Has a job done. An error is that no process can be started.
    fn ask(&self, process: &mut Option<Process>, id: &str, task: &Task) -> Result<Reply, Failure> {
        // Keep the running process, or start one.
        let started = match process.take() {
            Some(running) => running,
            None => Process::start(self)?,
        };
        let started = process.insert(started);

        // Send the order, and wait for the reply.
        let order = Order {
            id: id.to_owned(),
            job: task.hash(),
            output: task.output.clone(),
            command: task.command.clone(),
        };
        match started.ask(&order) {
            Some(reply) => Ok(reply),
            None => {
                // Report a process that ended as a failed job.
                let (code, ended) =
                    process.take().map_or_else(Default::default, Process::how_it_ended);
                Ok(Reply {
                    code: code.unwrap_or(BROUGHT_DOWN),
                    outputs: Vec::new(),
                    told: vec![format!("it brought its process down: {ended}")],
                    seconds: 0.0,
                })
            }
        }
    }
}

/// A process that does jobs.
struct Process {
    child: Child,
    orders: ChildStdin,
    replies: BufReader<ChildStdout>,
}

impl Process {
    fn start(pool: &Pool<'_>) -> Result<Self, Failure> {
        let failed =
            |e: std::io::Error| Failure::other(format!("no process can be started for jobs: {e}"));

        // Build the command of the worker.
        let mut command = program::command().map_err(failed)?;
        command
            .arg("batch-worker")
            .arg("--record")
            .arg(&pool.record)
            .arg(format!("--threads={}", pool.threads));

        // Start it with pipes for orders and replies.
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
        let orders = child.stdin.take().expect("it is a pipe");
        let replies = BufReader::new(child.stdout.take().expect("it is a pipe"));
        Ok(Self { child, orders, replies })
    }

    /// The reply to an order; `None` if the process ends instead.
    fn ask(&mut self, order: &Order) -> Option<Reply> {
        let mut line = serde_json::to_string(order).expect("keys are strings");
        line.push('\n');
        self.orders.write_all(line.as_bytes()).and_then(|()| self.orders.flush()).ok()?;
        line.clear();
        self.replies.read_line(&mut line).ok()?;
        serde_json::from_str(&line).ok()
    }

    /// Its exit code, if it ended by itself and with a failure, and that in words.
    fn how_it_ended(mut self) -> (Option<u8>, String) {
        // A process whose replies cannot be read ends with its orders.
        drop(self.orders);

        // Take its exit status apart.
        match self.child.wait() {
            Ok(status) => {
                let code = status.code().and_then(|code| u8::try_from(code).ok());
                (code.filter(|code| *code != 0), status.to_string())
            }
            Err(e) => (None, e.to_string()),
        }
    }

    /// Ends it by the end of its orders.
    fn end(self) {
        let Self { mut child, orders, .. } = self;
        drop(orders);
        let _ = child.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_of_a_model_go_to_one_process_while_there_are_others() {
        let job = |model: &str, n: usize| Job {
            id: format!("{model}{n}"),
            task: Ok(Task {
                models: vec![model.to_owned()],
                output: format!("{model}{n}.png"),
                command: Vec::new(),
            }),
        };
        let all = [job("a", 0), job("b", 0), job("a", 1), job("a", 2), job("b", 1)];
        let mut queue = Queue::new(&all.iter().collect::<Vec<_>>());
        let (mut first, mut second) = (None, None);
        let mut next = |at: &mut Option<usize>| queue.next(at).map(|(id, _)| id.to_owned());
        assert_eq!([next(&mut first), next(&mut second)], [Some("a0".into()), Some("b0".into())]);
        assert_eq!([next(&mut second), next(&mut first)], [Some("b1".into()), Some("a1".into())]);
        // Nothing else is left: the second helps with the first's.
        assert_eq!(next(&mut second), Some("a2".into()));
        assert_eq!([next(&mut first), next(&mut second)], [None, None]);
    }
}

//! `log.csv`: one line for each tick of a run; a tick is a millisecond of the motion board.
//!
//! While the job runs a [`LogWriter`] writes what the motion board tells, so that it is there whatever becomes of this
//! program. Once the job is evaluated the log is written anew, with what is only known then: places, feeds and true values.

use config::machine::{MachineFile, OutputNames};
use evaluate::WorkTick;
use host_link::events::{Event, Subscription};
use shared::io::{AXES, AXIS_NAMES, MOTOR_NAMES, MOTORS, SLIDE_NAMES};
use shared::protocol::MotionSample;
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Name of the log in the folder of a report.
pub const LOG: &str = "log.csv";
/// The log on the disk is never older than this while a job runs.
const FLUSH: Duration = Duration::from_millis(200);

/// The columns of a log: those of what the machine has.
#[derive(Clone, Copy, Debug)]
pub struct LogColumns {
    axes: [bool; AXES],
    motors: [bool; MOTORS],
    slides: bool,
    /// Outputs of the process.
    outputs: bool,
}

impl LogColumns {
    /// Of `machine`.
    pub fn of(machine: &MachineFile) -> Self {
        Self {
            axes: machine.motion.kinematics.fitted(),
            motors: machine.motion.motors.each_ref().map(Option::is_some),
            slides: machine.tracking.is_some(),
            outputs: machine.outputs != OutputNames::default(),
        }
    }

    fn slide_names(&self) -> impl Iterator<Item = String> + Clone {
        let names = if self.slides { &SLIDE_NAMES[..] } else { &[] };
        names.iter().map(|name| name.to_lowercase())
    }

    fn heading(&self, out: &mut impl Write) -> io::Result<()> {
        write!(
            out,
            "tick,time_s,path,s_mm,along_mm,speed_m_per_min,feed_m_per_min,true_speed_m_per_min,beam_1,beam_2,power_1,power_2"
        )?;
        if self.outputs {
            write!(out, ",outputs,analog_1,analog_2")?;
        }
        for name in self.slide_names() {
            write!(out, ",deviation_{name}_mm")?;
        }
        write!(out, ",contour_error_mm")?;
        for name in self.slide_names() {
            write!(out, ",slide_{name}_mm")?;
        }
        for axis in (0..AXES).filter(|axis| self.axes[*axis]) {
            write!(
                out,
                ",{}_{}",
                AXIS_NAMES[axis],
                if axis >= 3 { "deg" } else { "mm" }
            )?;
        }
        for motor in (0..MOTORS).filter(|motor| self.motors[*motor]) {
            let unit = if is_rotary(motor) { "deg" } else { "mm" };
            write!(out, ",following_error_{}_{unit}", MOTOR_NAMES[motor])?;
        }
        writeln!(out)
    }

    /// A tick as the motion board told it, and what is known of it by now; unknown values are empty.
    fn line(&self, out: &mut impl Write, sample: &MotionSample, work: Option<&WorkTick>) -> io::Result<()> {
        write!(
            out,
            "{},{:.6},{},{:.6},",
            sample.tick,
            sample.time_us as f64 * 1e-6,
            sample.path_id,
            sample.s_mm
        )?;
        let m_min = |mm_s: f64| mm_s / MM_S_PER_M_MIN;
        value(out, work.map(|work| work.along_mm), 6)?;
        write!(out, ",{:.6},", m_min(sample.speed_mm_s))?;
        value(out, work.map(|work| m_min(work.feed_mm_s)), 6)?;
        write!(out, ",")?;
        value(out, work.and_then(|work| work.true_speed_mm_s).map(m_min), 6)?;
        let [beam_1, beam_2] = sample.beams.map(u8::from);
        let [power_1, power_2, analog_1, analog_2] = sample.levels;
        write!(out, ",{beam_1},{beam_2},{power_1:.4},{power_2:.4}")?;
        if self.outputs {
            write!(out, ",{},{analog_1:.4},{analog_2:.4}", sample.outputs)?;
        }
        for slide in self.slide_names().enumerate().map(|(slide, _)| slide) {
            write!(out, ",")?;
            value(out, work.and_then(|work| work.deviation_mm[slide]), 7)?;
        }
        write!(out, ",")?;
        value(out, work.and_then(|work| work.contour_error_mm), 7)?;
        for slide in self.slide_names().enumerate().map(|(slide, _)| slide) {
            write!(out, ",")?;
            value(out, work.and_then(|work| Some(work.slides_mm?[slide])), 7)?;
        }
        for axis in (0..AXES).filter(|axis| self.axes[*axis]) {
            let unit = if axis >= 3 { DEG_PER_RAD } else { 1.0 };
            write!(out, ",{:.6}", sample.axes[axis] * unit)?;
        }
        for motor in (0..MOTORS).filter(|motor| self.motors[*motor]) {
            let unit = if is_rotary(motor) { DEG_PER_RAD } else { 1.0 };
            write!(out, ",{:.7}", f64::from(sample.following_error[motor]) * unit)?;
        }
        writeln!(out)
    }
}

fn value(out: &mut impl Write, value: Option<f64>, decimals: usize) -> io::Result<()> {
    match value {
        Some(value) => write!(out, "{value:.decimals$}"),
        None => Ok(()),
    }
}

/// Whether a motor turns.
pub(super) fn is_rotary(motor: usize) -> bool {
    motor >= 4
}

/// Writes the log of a run that is evaluated: all ticks of the motion board, with what is known of those that work.
pub(super) fn write(
    path: &Path,
    columns: &LogColumns,
    samples: impl IntoIterator<Item = MotionSample>,
    ticks: impl IntoIterator<Item = WorkTick>,
) -> io::Result<()> {
    // Of a long run this takes minutes, in which the one written while the job ran stays.
    let new = path.with_extension("csv.new");
    let mut out = BufWriter::new(File::create(&new)?);
    let written = all(&mut out, columns, samples, ticks).and_then(|()| out.flush());
    drop(out);
    let replaced = written.and_then(|()| std::fs::rename(&new, path));
    if replaced.is_err() {
        // What there is of it is of no use.
        let _ = std::fs::remove_file(&new);
    }
    replaced
}

fn all(
    out: &mut impl Write,
    columns: &LogColumns,
    samples: impl IntoIterator<Item = MotionSample>,
    ticks: impl IntoIterator<Item = WorkTick>,
) -> io::Result<()> {
    columns.heading(out)?;
    let mut ticks = ticks.into_iter().peekable();
    for sample in samples {
        // The tick of a sample that cannot be read again.
        while ticks.next_if(|tick| is_before(tick.tick, sample.tick)).is_some() {}
        let work = ticks.next_if(|tick| tick.tick == sample.tick);
        columns.line(out, &sample, work.as_ref())?;
    }
    Ok(())
}

/// Whether a tick comes before another one; they begin anew after 49 days.
fn is_before(tick: u32, other: u32) -> bool {
    (tick.wrapping_sub(other) as i32) < 0
}

/// Writes a log while the job runs.
pub struct LogWriter {
    path: PathBuf,
    thread: JoinHandle<io::Result<u64>>,
}

impl LogWriter {
    /// Begins a log in `folder` with what `events` tell; it goes on until they end.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn start(folder: &Path, columns: LogColumns, events: Subscription) -> io::Result<Self> {
        let path = folder.join(LOG);
        let file = File::create(&path)?;
        let thread = std::thread::spawn(move || follow(BufWriter::new(file), &columns, events));
        Ok(Self { path, thread })
    }

    /// Waits for the end of the job: the events that the log had to leave out, as the disk was too slow.
    ///
    /// # Errors
    /// What the disk says, with the file.
    pub fn end(self) -> io::Result<u64> {
        let ended = self
            .thread
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        ended.map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", self.path.display())))
    }
}

fn follow(mut out: BufWriter<File>, columns: &LogColumns, events: Subscription) -> io::Result<u64> {
    columns.heading(&mut out)?;
    let (mut flushed, mut lost) = (Instant::now(), 0);
    for received in events {
        lost += received.lost;
        if let Event::MotionSamples(samples) = &*received.event {
            for sample in samples.iter() {
                columns.line(&mut out, sample, None)?;
            }
        }
        if flushed.elapsed() >= FLUSH {
            out.flush()?;
            flushed = Instant::now();
        }
    }
    out.flush()?;
    Ok(lost)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use shared::state::State;

    const ALL: LogColumns = LogColumns {
        axes: [true; AXES],
        motors: [true; MOTORS],
        slides: true,
        outputs: true,
    };

    pub(crate) fn tick(tick: u32) -> WorkTick {
        WorkTick {
            tick,
            path_id: 1,
            s_mm: 0.1 * f64::from(tick),
            along_mm: 0.1 * f64::from(tick),
            speed_mm_s: 5.0 * MM_S_PER_M_MIN,
            feed_mm_s: 5.0 * MM_S_PER_M_MIN,
            true_speed_mm_s: Some(4.9 * MM_S_PER_M_MIN),
            beams: [true, false],
            slides_mm: None,
            deviation_mm: [Some(0.012), Some(-0.003), None, None],
            contour_error_mm: Some(0.001),
            following_error: [0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0.002],
        }
    }

    fn sample(tick: u32) -> MotionSample {
        MotionSample {
            tick,
            time_us: 1000 * u64::from(tick),
            state: State::Running,
            path_id: 1,
            s_mm: 0.1 * f64::from(tick),
            speed_mm_s: 5.0 * MM_S_PER_M_MIN,
            beams: [true, false],
            outputs: 5,
            inputs: 0,
            levels: [0.25, 0.0, 0.5, 0.0],
            switched: shared::io::SwitchedLines::NONE,
            axes: [10.0, 20.0, 30.0, 0.0, 0.0, std::f64::consts::PI],
            truth: None,
            following_error: [0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0.002],
            skew_mm: 0.0,
            load: None,
        }
    }

    fn text(columns: &LogColumns) -> String {
        let mut out = Vec::new();
        all(&mut out, columns, [sample(3), sample(4)], [tick(4)]).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn every_tick_has_a_line_with_the_columns_of_the_heading_and_unknown_values_are_empty() {
        let text = text(&ALL);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert_eq!(line.len(), lines[0].len());
        }
        let value = |row: usize, name: &str| lines[row][lines[0].iter().position(|n| *n == name).unwrap()];
        assert_eq!((value(2, "tick"), value(2, "time_s")), ("4", "0.004000"));
        assert_eq!(value(2, "speed_m_per_min"), "5.000000");
        assert_eq!(value(2, "true_speed_m_per_min"), "4.900000");
        assert_eq!((value(2, "beam_1"), value(2, "beam_2")), ("1", "0"));
        assert_eq!(
            (value(2, "power_1"), value(2, "outputs"), value(2, "analog_1")),
            ("0.2500", "5", "0.5000")
        );
        assert_eq!(value(2, "deviation_v1_mm"), "-0.0030000");
        assert_eq!((value(2, "deviation_u2_mm"), value(2, "slide_u1_mm")), ("", ""));
        assert_eq!(value(2, "following_error_C_deg"), "0.1145916");
        assert_eq!((value(2, "Y_mm"), value(2, "C_deg")), ("20.000000", "180.000000"));
        // Of a tick that does not work.
        assert_eq!((value(1, "tick"), value(1, "along_mm")), ("3", ""));
        assert_eq!(value(1, "s_mm"), "0.300000");
    }

    #[test]
    fn ticks_go_to_the_lines_of_their_samples_whatever_is_missing() {
        let mut out = Vec::new();
        let samples = [u32::MAX, 1, 2, 4].map(sample);
        all(&mut out, &ALL, samples, [u32::MAX, 0, 2, 3, 4].map(tick)).unwrap();
        let text = String::from_utf8(out).unwrap();
        let along: Vec<&str> = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(4).unwrap())
            .collect();
        assert_eq!(along, ["429496729.500000", "", "0.200000", "0.400000"]);
    }

    #[test]
    fn there_are_no_columns_of_what_the_machine_does_not_have() {
        let mut columns = ALL;
        (columns.slides, columns.outputs) = (false, false);
        (columns.axes[4], columns.motors[5]) = (false, false);
        columns.motors[1] = false;
        let text = text(&columns);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines[0].len(), lines[1].len());
        let has = |part: &str| lines[0].iter().any(|name| name.contains(part));
        assert!(!has("outputs") && !has("analog"));
        assert!(!has("slide") && !has("deviation") && !has("X2") && !has("B_deg"));
        assert!(has("contour_error_mm") && has("following_error_X1_mm") && has("A_deg"));
    }

    #[test]
    fn a_log_is_on_the_disk_while_the_job_runs() {
        let folder = std::env::temp_dir().join(format!("seamwright-log-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (remote, control) = host_link::control();
        let events = remote.subscribe(host_link::events::Interest::Samples, 1000);
        let log = LogWriter::start(&folder, ALL, events).unwrap();
        let read = || std::fs::read_to_string(folder.join(LOG)).unwrap();
        // Two batches further apart than a flush: the first is there before the job ends.
        for first in [1, 3] {
            std::thread::sleep(FLUSH + Duration::from_millis(20));
            let samples = [sample(first), sample(first + 1)];
            control.publish(Event::MotionSamples(samples.as_slice().into()));
        }
        let seen = (0..100).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            read().lines().count() >= 3
        });
        assert!(seen, "{}", read());
        drop(control);
        assert_eq!(log.end().unwrap(), 0);
        assert_eq!(read().lines().count(), 5);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

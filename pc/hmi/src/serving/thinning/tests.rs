use super::*;
use crate::live::Signal;
use crate::viewing::watched::Watched;
use cam::along::Along;
use host_link::events::{Focus, MeasuredPicture, SeamInPicture};
use shared::io::SwitchedLines;
use shared::io::{AXES, LEVELS, MOTORS, SLIDES};
use shared::state::{State, TrackerState};

/// Ticks of each board a message: 20 messages a second of ticks a millisecond apart.
const A_MESSAGE: u64 = 50;
/// Speed of the weld, 9 m/min \[mm/s\].
const SPEED: f64 = 150.0;
/// Bytes a second that a viewer may take.
const MAY_BE: usize = 300_000;

/// Path 1 welds from its beginning on.
fn along() -> Along {
    serde_json::from_str(r#"{"begins_mm": {"1": 0.0}}"#).unwrap()
}

/// A weld as it is told in a job, tick by tick.
struct Weld {
    thinner: Thinner,
    ms: u64,
    random: u64,
    /// Deviations of each tick, made in place of what is drawn at random.
    peaks: Vec<(u64, usize, f64)>,
}

impl Weld {
    fn new() -> Self {
        let thinner = Thinner {
            live: Live::new(along(), Journal::default()),
            ..Thinner::default()
        };
        Self {
            thinner,
            ms: 0,
            random: 1,
            peaks: Vec::new(),
        }
    }

    /// From 0 to 1: the generator of Knuth's MMIX.
    fn random(&mut self) -> f64 {
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 40) as f64 / f64::from(1 << 24)
    }

    fn now(&self) -> Duration {
        Duration::from_millis(self.ms)
    }

    /// The next millisecond; pictures of both cameras 200 times a second, each grainy all over.
    fn tick(&mut self) {
        let following_error = std::array::from_fn(|_| self.random() as f32 * 0.01);
        let motion = MotionSample {
            tick: self.ms as u32,
            time_us: self.ms * 1000,
            state: State::Running,
            path_id: 1,
            s_mm: SPEED * self.ms as f64 * 1e-3,
            speed_mm_s: SPEED,
            beams: [true; SIDES],
            outputs: 0,
            inputs: 0,
            levels: [0.5; LEVELS],
            switched: SwitchedLines::NONE,
            axes: std::array::from_fn(|_| self.random() * 100.0),
            truth: Some([1.0; MOTORS]),
            following_error,
            skew_mm: self.random() as f32 * 0.01,
            load: None,
        };
        let peak = |slide: usize| {
            self.peaks
                .iter()
                .find(|peak| (peak.0, peak.1) == (self.ms, slide))
        };
        let peaks: [Option<f64>; SLIDES] = std::array::from_fn(|slide| peak(slide).map(|peak| peak.2));
        let noise: [f64; SLIDES] = std::array::from_fn(|_| (self.random() - 0.5) * 0.004);
        let tracker = TrackerSample {
            tick: self.ms as u32,
            time_us: self.ms * 1000,
            state: TrackerState::Tracking,
            fault: None,
            slides_mm: std::array::from_fn(|slide| 5.0 + peaks[slide].unwrap_or(noise[slide])),
            truth_mm: None,
            target_mm: [5.0; SLIDES],
            dac: [0; SLIDES],
        };
        let now = self.now();
        self.thinner.take(&Event::MotionSamples(Arc::new([motion])), now);
        self.thinner
            .take(&Event::TrackerSamples(Arc::new([tracker])), now);
        if self.ms.is_multiple_of(5) {
            for side in 0..SIDES {
                let picture = self.picture(side);
                self.thinner.take(&Event::Picture(Arc::new(picture)), now);
            }
        }
        self.ms += 1;
    }

    fn picture(&mut self, side: usize) -> MeasuredPicture {
        let (rows, columns) = (300, 400);
        let bright = |at: usize| if at / columns < 150 { 60.0 } else { 140.0 };
        let capture = self.ms as u32;
        let pixels = (0..rows * columns).map(|at| (bright(at) + 60.0 * self.random()) as u8);
        MeasuredPicture {
            side,
            capture,
            rows,
            columns,
            pixels: pixels.collect(),
            seam: Some(SeamInPicture {
                lateral_mm: 0.0,
                travel_mm: 0.0,
                height_mm: Some(0.0),
                width_mm: 0.1,
                quality: 1.0,
                edges: [[[0.0; 2]; 2]; 2],
            }),
            measurement: None,
            focus: Focus::default(),
        }
    }

    /// What is told of the next 50 ms, and its bytes.
    fn message(&mut self) -> (Message, usize) {
        (0..A_MESSAGE).for_each(|_| self.tick());
        let message = self.thinner.changes(self.now());
        let bytes = message.encode().unwrap().len();
        self.thinner.sent(bytes);
        (message, bytes)
    }
}

#[test]
fn a_viewer_takes_less_than_300_kilobytes_in_any_second_of_a_weld_with_pictures() {
    let mut weld = Weld::new();
    let messages: Vec<(Message, usize)> = (0..200).map(|_| weld.message()).collect();
    let worst = messages
        .windows(20)
        .map(|second| second.iter().map(|(_, bytes)| bytes).sum::<usize>())
        .max()
        .unwrap();
    let is_picture = |update: &&Update| matches!(update, Update::Picture(_));
    let pictures = messages
        .iter()
        .flat_map(|(message, _)| &message.updates)
        .filter(is_picture);
    let pictures = pictures.count();
    println!("{worst} bytes in the worst second, {pictures} pictures in 10 s");
    assert!(worst < MAY_BE, "{worst}");
    assert!(pictures > 40, "{pictures}");
}

#[test]
fn every_peak_of_a_deviation_and_of_a_following_error_is_told() {
    let mut weld = Weld::new();
    weld.peaks = vec![(1234, 0, 0.043), (1235, 0, -0.021), (2001, 3, -0.037)];
    let mut watched = Watched::default();
    let mut largest = [0.0_f32; MOTORS];
    for _ in 0..60 {
        let (message, _) = weld.message();
        for update in &message.updates {
            if let Update::Motion(samples) = update {
                assert!(samples.len() <= TICKS);
                for sample in samples {
                    for (largest, error) in largest.iter_mut().zip(sample.following_error) {
                        *largest = largest.max(error);
                    }
                }
            }
        }
        watched.take(Message::decode(&message.encode().unwrap()).unwrap(), weld.now());
    }
    let (own, seen) = (&weld.thinner.live, &watched.live);
    assert_eq!(own.deviations.worst(), seen.deviations.worst());
    assert!((seen.deviations.worst()[0].unwrap() - 0.043).abs() < 1e-12);
    let at = |ms: f64| SPEED * ms * 1e-3;
    let worst = |ms: f64| seen.deviations.worst_between(at(ms), at(ms)).unwrap();
    assert!((worst(2001.0) - 0.037).abs() < 1e-8, "{}", worst(2001.0));
    let course = seen.signals.course(Signal::SlideError(0), 60.0, usize::MAX);
    let told = |value_um: f64| course.iter().any(|[_, value]| (value - value_um).abs() < 1e-9);
    assert!(told(43.0) && told(-21.0));
    let all = own.signals.newest(60.0).0;
    for (motor, largest) in largest.into_iter().enumerate() {
        let expected = all
            .iter()
            .map(|tick| tick.following_error[motor])
            .fold(0.0, f32::max);
        assert!((largest - expected).abs() < 1e-9, "{motor}");
    }
    assert!(
        seen.signals
            .newest(60.0)
            .0
            .iter()
            .all(|tick| tick.truth.is_none())
    );
    assert_eq!(AXES, seen.newest.unwrap().axes.len());
}

#[test]
fn who_comes_late_is_told_the_same_as_who_was_there_all_the_time() {
    let mut weld = Weld::new();
    let mut there = Watched::default();
    let alarm = |journal: &mut Journal, text: &str| journal.alarm(Duration::ZERO, text);
    alarm(&mut weld.thinner.journal, "the first");
    for turn in 0..60 {
        if turn == 30 {
            weld.thinner.journal.acknowledge();
            alarm(&mut weld.thinner.journal, "the second");
        }
        there.take(weld.message().0, weld.now());
    }
    let all = weld.thinner.all(weld.now()).encode().unwrap();
    println!("{} bytes at once", all.len());
    let mut late = Watched::default();
    late.take(Message::decode(&all).unwrap(), weld.now());
    assert_eq!(there.live.deviations, late.live.deviations);
    let open = |watched: &Watched| watched.live.journal.open_alarms().count();
    assert_eq!((open(&there), open(&late)), (1, 1));
    assert_eq!(
        there.live.newest.map(|tick| tick.tick),
        late.live.newest.map(|tick| tick.tick)
    );
    assert!(late.live.pictures.iter().all(Option::is_some));
    assert_eq!(there.age(weld.now()), late.age(weld.now()));
    // Ticks of both boards lie where they belong in time.
    for watched in [&there, &late] {
        let signals = &watched.live.signals;
        let newest = signals.course(Signal::SlideError(0), 1.0, usize::MAX);
        let [newest_s, _] = newest.last().copied().unwrap();
        assert!((newest_s - signals.newest_s()).abs() < 2e-3, "{newest_s}");
    }
}

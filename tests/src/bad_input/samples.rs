//! What inputs are made of: shipped files, long ones shortened, and small ones of every form.

use super::{Kind, Reader};
use crate::fuzz::seldom;
use crate::shipped;
use config::machine::MachineFile;
use png::{BitDepth, ColorType, Encoder};
use shared::protocol::framing::{MAX_DATAGRAM, MAX_MESSAGE, encode_datagram, encode_message};
use shared::protocol::{Datagram, Measurement, Refusal, Request, Response, SideMeasurement};
use std::fmt::Write;

/// Lines of a long table or program that stay: some at its head, some at its end.
const STAY: [usize; 2] = [24, 2];
/// Longest text that is taken as it is \[bytes\].
const SHORT: usize = 2500;

/// An input without a mistake.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Where it comes from.
    pub name: String,
    /// The input.
    pub bytes: Vec<u8>,
    /// What reads it.
    pub reader: Reader,
}

/// All samples of a kind.
pub fn samples(kind: Kind) -> Vec<Sample> {
    match kind {
        Kind::Nc => programs(),
        Kind::Csv => tables(),
        Kind::Toml => settings(),
        Kind::Json => curves(),
        Kind::Png => pictures(),
        Kind::Framing => messages(),
    }
}

fn sample(name: &str, text: impl Into<Vec<u8>>, reader: Reader) -> Sample {
    Sample {
        name: name.to_owned(),
        bytes: text.into(),
        reader,
    }
}

/// A shipped file without comments, the middle left out if it is long.
fn file(name: &str, reader: Reader) -> Sample {
    let text = std::fs::read_to_string(shipped(name)).expect("a shipped file");
    let lines: Vec<&str> = text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with(['#', '(']))
        .collect();
    let [head, end] = STAY;
    let lines = match name.ends_with(".toml") || text.len() < SHORT {
        true => lines,
        false => [&lines[..head], &lines[lines.len() - end..]].concat(),
    };
    sample(name, lines.join("\n") + "\n", reader)
}

fn programs() -> Vec<Sample> {
    /// Every word of the dialect, one program a machine.
    const SMALL: [(&str, &str); 7] = [
        (
            "dual-beam-gantry",
            "%\nN10 G21 G17 G90 G94 G40 G54 G64 P0.05\nG43.4\nG0 X900 Y900 Z250 A0 B0 C0 V1=0 V2=0\nG0 Z100\n\
             F3000 M67 E0 Q500\nG1 X950 (run-in)\nM62 P0\nG3 X970 Y920 I0 J20 C9\nG2 X990 Y940 R20 C0\nM63 P0\n\
             G1 X1000\nG4 P0.5\nM64 P0\nG1 X1010\nM65 P0\nM68 E0 Q0\nG53 G0 Z900\nM30\n%\n",
        ),
        (
            "wire-arc",
            "G21 G43.4\nG0 X600 Y350 Z150 A0 B0 C0\nG0 Z50\nG93 G1 X625 F12\nG18 G2 X635 Z50 I5 K0 F10\nG94 F600\n\
             G17 G61\nG3 X645 Y350 I5 J2 P3\nG64\nG19 G2 Y360 Z50 R10\nM2\n",
        ),
        (
            "wire-arc",
            "G21 G43.4\nG0 X600 Y350 Z150 A0 B0 C0\nF600\nG5.2 X610 Y350 P1 L3\nX620 Y360 P1\nX630 Y350 P0.5\nX640 Y350 P2\n\
             G5.3\nG6.2 X650 Y360 Z150 P4 K0\nX660 Y370 Z151 R1 K0\nX670 Y350 K0\nX680 Y350 C10 K0\nK1\nK1\nK1\nK1\nG6.3\n\
             G1 X690\nM2\n",
        ),
        (
            "stir-gantry",
            "G43.4\nG53 G0 Z200\nG53 G0 B-2.5 C0\nG0 X250 Y215 Z200 B-2.5 C0\nG0 Z67\nS600 M3\nF40 G1 Z61\nG4 P2.5\n\
             G4 P0.001\nF60 G1 X260 C0\nG3 X290 Y225 I0 J50 C36.869898\nS500\nG1 Z67\nM5\nG0 Z200\nM2\n",
        ),
        (
            "pipe-welder",
            "G43.4\nG53 G0 X200 Z300 B0 C0\nG53 G0 C360\n/G53 G0 C10\nG53 G0 Z250 ; end\nM2\n",
        ),
        (
            "ac-head",
            "G43.4\nG0 X900 Y700 Z300 A5 C0\nG64 P0.02\nF1000\nG1 X910 A6 C1\nG1 X920 A5.5\nG1 Z290\nM2\n",
        ),
        (
            "ac-head",
            "G5.1 Q1\nG43.5 H1 G642\nTRAORI ORIAXES\no100 sub\nG91 G1 Z-#1 F600\nG90\no100 endsub\n#2=[10/4]\nG10 L2 P2 X400 Y300 R30\n\
             G55 G0 X100 Y50 Z300 A5 C0\no100 call [#2]\nG20 G0 X5 (MSG, inches)\nG21\n\
             G81 X110 Y60 Z200 R250 F600\nG80\nG28\nM2\n",
        ),
    ];
    let mut samples = vec![
        file("programs/t-seam-400.ngc", Reader::Program("dual-beam-gantry")),
        file("programs/saddle-320-80.ngc", Reader::Program("pipe-welder")),
        file("programs/leaf.ngc", Reader::Program("wire-arc")),
        file("programs/stir-contour.ngc", Reader::Program("stir-gantry")),
    ];
    samples.extend(SMALL.map(|(machine, text)| sample("small program", text, Reader::Program(machine))));
    samples
}

fn tables() -> Vec<Sample> {
    const TAUGHT_SEAM: &str = "# machine: gantry\n# part: t-seam\n\
        point,side,s_mm,x_mm,y_mm,z_mm,nx,ny,nz,width_mm,quality,scatter_mm,pictures\n";
    let mut seam = TAUGHT_SEAM.to_owned();
    let mut panel = String::from("x_mm,y_mm,z_mm,nx,ny,nz,error_deg,rings,time_s\n");
    for k in 0..10 {
        let x = 400.0 + 30.0 * f64::from(k);
        for (side, y) in [(1, 300.0), (2, 303.0)] {
            let (point, s) = (k + 1, 30 * k);
            writeln!(seam, "{point},{side},{s},{x},{y},96.5,0,0,1,0.1,0.9,0.001,8").expect("text");
        }
        let x = 850.0 + 10.0 * f64::from(k);
        writeln!(
            panel,
            "{x},700,{},0.05,0,0.99,0.1,2,5.5",
            148.0 - 0.5 * f64::from(k)
        )
        .expect("text");
    }
    vec![
        file("programs/t-seam-400-deviation.csv", Reader::Deviation),
        sample(
            "deviation",
            "\u{feff}s_mm, u1_mm,v1_mm,u2_mm,v2_mm\r\n# flat\r\n-10,0,0,0,0\r\n\r\n200, 0.5,0,-0.5,0\r\n420,0,0,0,0\r\n",
            Reader::Deviation,
        ),
        file("programs/t-seam-400-seam1.csv", Reader::MainCurve),
        file("programs/t-seam-400-seam2.csv", Reader::OtherCurve),
        sample("taught seam", seam, Reader::TaughtSeam),
        sample("taught panel", panel, Reader::PanelPoints),
        file("programs/saddle-taught.csv", Reader::SaddlePoints),
        file("programs/lap-joint-taught.csv", Reader::Places),
        sample(
            "captures",
            "capture,time_us,file\n7,35000,a.png\n8,40000,b.png\n",
            Reader::Captures,
        ),
        sample(
            "known pictures",
            "file,u_mm,v_mm\na.png,0.1,-0.2\nb.png,0,1e-1\n",
            Reader::KnownPictures,
        ),
    ]
}

fn settings() -> Vec<Sample> {
    let gantry = "dual-beam-gantry";
    let machine = MachineFile::read(&shipped(crate::MACHINE)).expect("the shipped machine");
    let cameras = &machine.tracking.expect("it has a tracker").cameras;
    let mut calibration = cameras.nominal(0);
    calibration.corner_offset_mm = Some([0.001, -0.002]);
    (calibration.optics.rows, calibration.optics.columns) = (120, 160);
    let nurbs = "[bead]\nwindow_mm_s = [4.0, 16.0]\npower_w = 2000.0\nlead_mm = 3.0\nattitude = \"tangent\"\n\
        [bead.nurbs]\ndegree = 2\ncontrol_points_mm = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [30.0, 30.0, 0.0]]\n\
        weights = [1.0, 0.7, 1.0]\nknots = [0, 0, 0, 1, 1, 1]\n";
    let parts = [
        ("t-seam-400", gantry),
        ("saddle-320-80", "pipe-welder"),
        ("saddle-taught", "pipe-welder"),
        ("panel", "ac-head"),
        ("stir-contour", "stir-gantry"),
        ("lap-joint", "wire-arc"),
    ];
    let mut samples: Vec<Sample> = parts
        .map(|(part, machine)| file(&format!("programs/{part}.toml"), Reader::Part(machine)))
        .into();
    samples.extend([
        sample("bead", nurbs, Reader::Part("wire-arc")),
        file("programs/welddata.toml", Reader::WeldData),
        file("programs/t-seam-400-disturbed.toml", Reader::Scene),
        sample("calibration", calibration.to_toml(), Reader::Calibration),
    ]);
    samples.extend(
        [gantry, "pipe-welder", "ac-head", "stir-gantry", "wire-arc"]
            .map(|machine| file(&format!("machines/{machine}.toml"), Reader::Machine)),
    );
    samples
}

fn curves() -> Vec<Sample> {
    const LINE: &str =
        "{\"degree\": 1, \"control_points_mm\": [[0, 0, 0], [50, 10, 0]], \"knots\": [0, 0, 1, 1]}";
    const CIRCLE: &str = "{\"degree\": 2, \"control_points_mm\": [[20, 0, 0], [20, 20, 0], [0, 20, 0], [-20, 20, 0], \
        [-20, 0, 0], [-20, -20, 0], [0, -20, 0], [20, -20, 0], [20, 0, 0]], \"weights\": [1, 0.7071067811865476, 1, \
        0.7071067811865476, 1, 0.7071067811865476, 1, 0.7071067811865476, 1], \"knots\": [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, \
        4, 4]}";
    const CUBIC: &str = "{\"degree\": 3, \"control_points_mm\": [[0.0, 0.0, 1.0], [20.0, 5.0, 1.5], [40.5, -5.0, 2.0], \
        [60.0, 0.0, 1e0], [80.0, 5.0, 1.0]], \"weights\": null, \"knots\": [0, 0, 0, 0, 0.5, 1, 1, 1, 1]}";
    [LINE, CIRCLE, CUBIC]
        .map(|text| sample("curve", text, Reader::Curve))
        .into()
}

fn pictures() -> Vec<Sample> {
    let sizes = [[8, 8], [64, 64], [1, 300], [33, 5]];
    let picture = |[columns, rows]: [u32; 2]| {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, columns, rows);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a header");
        let length = columns as usize * rows as usize;
        let pixels: Vec<u8> = (0..length).map(|k| (7 * k % 251) as u8).collect();
        writer.write_image_data(&pixels).expect("pixels");
        drop(writer);
        sample("picture", bytes, Reader::Picture)
    };
    sizes.map(picture).into()
}

fn messages() -> Vec<Sample> {
    let machine = MachineFile::read(&shipped(crate::MACHINE)).expect("the shipped machine");
    let tracker = machine.tracking.expect("it has a tracker").board;
    let mut requests = seldom();
    requests.extend([
        Request::Hello { schema_hash: 1 },
        Request::ConfigureMotion(machine.motion),
        Request::ConfigureTracker(tracker),
    ]);
    let mut buffer = [0; MAX_MESSAGE];
    let mut samples: Vec<Sample> = requests
        .iter()
        .map(|request| encode_message(request, &mut buffer).expect("it fits").to_vec())
        .map(|bytes| sample("request", bytes, Reader::Stream))
        .collect();
    for response in [Response::Done, Response::Refused(Refusal::NotHomed)] {
        let bytes = encode_message(&response, &mut buffer).expect("it fits");
        samples.push(sample("response", bytes, Reader::Stream));
    }
    let side = SideMeasurement {
        along_mm: 10.0,
        delta_u_mm: 0.1,
        delta_v_mm: -0.1,
    };
    let measurement = Measurement {
        capture: 7,
        sides: [Some(side), None],
    };
    let mut buffer = [0; MAX_DATAGRAM];
    let bytes = encode_datagram(3, &Datagram::Measurement(measurement), &mut buffer).expect("it fits");
    samples.push(sample("datagram", bytes, Reader::Datagram));
    samples
}

//! NURBS curves: points and derivatives, lengths, steps and discretisation (mathematics 3.1, 3.2, 3.5, 3.6).

use super::file::{Golden, near, number, numbers};
use super::stepping::{chord_height_radius, length_in_parts, newton_step, taylor_1, taylor_2, walk};
use curves::nurbs::{Curve, Discretisation, Nurbs, NurbsError, curvature, discretise, length};
use nalgebra::Vector3;
use serde_json::Value;

/// What a curve is made of.
struct Definition {
    degree: usize,
    points: Vec<Vector3<f64>>,
    weights: Vec<f64>,
    knots: Vec<f64>,
}

/// A vector of two or three coordinates; the third is 0.
fn point(value: &Value) -> Vector3<f64> {
    let mut coordinates = numbers(value);
    coordinates.resize(3, 0.0);
    Vector3::from_column_slice(&coordinates)
}

impl Definition {
    fn read(input: &Value) -> Self {
        Self {
            degree: input["degree"].as_u64().expect("degree") as usize,
            points: input["ctrl"]
                .as_array()
                .expect("ctrl")
                .iter()
                .map(point)
                .collect(),
            weights: numbers(&input["w"]),
            knots: numbers(&input["knots"]),
        }
    }

    /// The curve, or nothing if the wanted error says there is none.
    fn curve(&self, case: &Value) -> Option<Nurbs<'_>> {
        let made: Result<_, NurbsError> = Nurbs::new(self.degree, &self.points, &self.weights, &self.knots);
        match (made, case["err"].as_str()) {
            (Ok(curve), None) => Some(curve),
            (Err(error), Some(wanted)) => {
                let text = error.to_string();
                assert!(
                    text.starts_with(wanted),
                    "case {}: {text}, golden {wanted}",
                    case["id"]
                );
                None
            }
            (made, wanted) => panic!("case {}: {made:?}, golden error {wanted:?}", case["id"]),
        }
    }

    /// Largest coordinate: what rounding is relative to.
    fn size(&self) -> f64 {
        self.points.iter().map(|p| p.amax()).fold(0.0, f64::max)
    }
}

/// Every field of an object, by name.
fn fields(value: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let object = value.as_object().expect("object");
    object.iter().map(|(name, value)| (name.as_str(), value))
}

/// Checks the file `nurbs_eval`.
pub fn nurbs_eval(golden: &Golden) {
    let relative = number(&golden.file["tol"], "rel");
    for case in &golden.cases {
        let definition = Definition::read(&case["in"]);
        let Some(curve) = definition.curve(case) else {
            continue;
        };
        let wanted = case["out"].as_array().expect("out");
        let parameters = numbers(&case["in"]["u"]);
        assert_eq!(wanted.len(), parameters.len(), "case {}", case["id"]);
        for (u, wanted) in parameters.into_iter().zip(wanted) {
            let at = curve.at(u);
            for (name, value) in fields(wanted) {
                let seen = match name {
                    "u" => {
                        near(case, "u", u, value.as_f64().expect("u"), 0.0);
                        continue;
                    }
                    "kappa" => {
                        // Along a straight line nothing but rounding is left of C′×C″.
                        let rounding = 1e-14 * at.second.norm() / at.first.norm_squared();
                        match (curvature(&at), value.as_f64()) {
                            (Ok(seen), Some(wanted)) => {
                                near(case, "kappa", seen, wanted, relative * wanted + rounding);
                            }
                            (Err(_), None) => {}
                            (seen, wanted) => panic!("case {}: {seen:?}, golden {wanted:?}", case["id"]),
                        }
                        continue;
                    }
                    "C" => at.value,
                    "C1" => at.first,
                    "C2" => at.second,
                    other => panic!("case {}: field {other} is not checked", case["id"]),
                };
                let wanted = point(value);
                let allowed = relative * wanted.norm() + 1e-13 * definition.size();
                near(case, name, (seen - wanted).norm(), 0.0, allowed);
            }
        }
    }
}

/// Checks the file `nurbs_step`. Lengths and radii have the tolerance its description names.
pub fn nurbs_step(golden: &Golden) {
    const RELATIVE: f64 = 1e-6;
    let parameter = number(&golden.file["tol"], "u");
    for case in &golden.cases {
        let definition = Definition::read(&case["in"]);
        let Some(curve) = definition.curve(case) else {
            continue;
        };
        let [u, ds] = ["u", "ds"].map(|name| number(&case["in"], name));
        let walk = walk(&curve, ds);
        let mut cuts = Vec::new();
        let fineness = Discretisation {
            tolerance: number(&case["in"], "tol"),
            max_turn: number(&case["in"], "ang"),
            max_chord: number(&case["in"], "maxlen"),
        };
        discretise(&curve, &fineness, |u| cuts.push(u)).expect("discretised");
        for (name, value) in fields(&case["out"]) {
            if name == "disc_u" {
                let wanted = numbers(value);
                assert_eq!(wanted.len(), cuts.len().min(40), "case {}", case["id"]);
                for (seen, wanted) in cuts.iter().zip(wanted) {
                    near(case, name, *seen, wanted, parameter);
                }
                continue;
            }
            let wanted = value.as_f64().unwrap_or(f64::INFINITY);
            let (seen, allowed) = match name {
                "length" => {
                    // The golden one has 16 parts a span; what finer parts change is its own error.
                    let [seen, finer] = [16, 32].map(|parts| length_in_parts(&curve, parts));
                    near(case, name, seen, wanted, RELATIVE * wanted);
                    (length(&curve), RELATIVE * wanted + 4.0 * (finer - seen).abs())
                }
                "taylor1" => (taylor_1(&curve, u, ds), parameter),
                "taylor2" => (taylor_2(&curve, u, ds), parameter),
                "newton" => (newton_step(&curve, u, ds), parameter),
                "n_newton" => (walk.len() as f64, 0.0),
                "u_10" => (walk[10], parameter),
                "u_100" => (walk[100], parameter),
                "u_last_but_one" => (walk[walk.len() - 2], parameter),
                "disc_n" => (cuts.len() as f64, 0.0),
                "rho_ch" => {
                    // The height of the middle is rounded like the coordinates; compare curvatures.
                    let points = [u, u + 1e-3, u + 2e-3].map(|u| curve.point(u));
                    let chord = (points[2] - points[0]).norm();
                    let rounding = 8.0 * 1e-15 * definition.size() / (chord * chord);
                    let (seen, wanted) = (1.0 / chord_height_radius(points), 1.0 / wanted);
                    near(case, name, seen, wanted, RELATIVE * wanted + rounding);
                    continue;
                }
                other => panic!("case {}: field {other} is not checked", case["id"]),
            };
            near(case, name, seen, wanted, allowed);
        }
    }
}

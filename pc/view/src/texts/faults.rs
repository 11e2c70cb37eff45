//! Faults of the boards in every language. In English they are the boards' own sentences.

use super::{Language, Words};
use shared::io::{AXIS_NAMES, MOTOR_NAMES, SIDES, SLIDE_NAMES};
use shared::state::{Fault, NoPermit, TrackerFault};

/// The sentence in the language: the fault's own in English, else the Chinese or the German one.
macro_rules! say {
    ($language:expr, $fault:expr, $chinese:literal, $german:literal) => {
        match $language {
            Language::English => $fault.to_string(),
            Language::Chinese => format!($chinese),
            Language::German => format!($german),
        }
    };
}

impl Words {
    /// A fault of the motion board.
    pub fn fault(self, fault: &Fault) -> String {
        let l = self.0;
        let motor_name = |motor: u8| MOTOR_NAMES[usize::from(motor)];
        let axis_name = |axis: u8| AXIS_NAMES[usize::from(axis)];
        match *fault {
            Fault::EmergencyStop => self.emergency_stop(fault),
            Fault::EmergencyStopChannels { closed } => self.channels(fault, closed),
            Fault::Drive { motor } => {
                let motor = motor_name(motor);
                say!(
                    l,
                    fault,
                    "{motor} 的驱动器报告故障；请查看驱动器上的显示",
                    "Der Antrieb von {motor} meldet eine Störung; am Antrieb selbst nachsehen"
                )
            }
            Fault::Laser { side } => {
                let laser = side + 1;
                say!(
                    l,
                    fault,
                    "激光器 {laser} 报告故障；请查看激光器上的显示",
                    "Laser {laser} meldet eine Störung; an der Quelle selbst nachsehen"
                )
            }
            Fault::BeamPower {
                side,
                commanded_w,
                measured_w,
            } => {
                let beam = side + 1;
                say!(
                    l,
                    fault,
                    "光束 {beam} 输出 {measured_w:.0} W，而指令为 {commanded_w:.0} W：检查激光源、其联锁，以及开关、功率和回读线路",
                    "Strahl {beam} gibt {measured_w:.0} W, befohlen sind {commanded_w:.0} W: Quelle, Verriegelung und die Leitungen für Tor, Leistung und Rückmeldung prüfen"
                )
            }
            Fault::BeamNotOff { side, measured_w } => {
                let beam = side + 1;
                say!(
                    l,
                    fault,
                    "光束 {beam} 在关闭状态下输出 {measured_w:.0} W：先断开其联锁，再检查激光源以及开关和回读线路",
                    "Strahl {beam} gibt {measured_w:.0} W bei geschlossenem Tor: Verriegelung öffnen, dann Quelle und die Leitungen für Tor und Rückmeldung prüfen"
                )
            }
            Fault::BeamPowerUnknown { side } => {
                let beam = side + 1;
                say!(
                    l,
                    fault,
                    "光束 {beam} 的功率不再被测量：检查其回读线路和转换器",
                    "Die Leistung von Strahl {beam} wird nicht mehr gemessen: Rückmeldung und Wandler prüfen"
                )
            }
            Fault::FollowingError {
                motor,
                seen_um,
                limit_um,
            } => {
                let motor = motor_name(motor);
                say!(
                    l,
                    fault,
                    "{motor} 的跟随误差为 {seen_um:.0} µm（或 m°），此处限值 {limit_um:.0}：检查轴是否卡住、增益和驱动比例",
                    "Schleppfehler von {motor} {seen_um:.0} µm (oder m°), die Grenze dort ist {limit_um:.0}: blockierte Achse, Verstärkungen und Skalierung des Antriebs prüfen"
                )
            }
            Fault::Vibration {
                motor,
                seen_um,
                limit_um,
            } => {
                let motor = motor_name(motor);
                say!(
                    l,
                    fault,
                    "{motor} 振动 {seen_um:.1} µm（或 m°）均方根，限值 {limit_um:.1}：检查联轴器或螺钉是否松动；若控制环自激，请重新调试或减小 kp",
                    "{motor} schwingt mit {seen_um:.1} µm (oder m°) effektiv, die Grenze ist {limit_um:.1}: lose Kupplung oder Schraube suchen; schwingt der Regelkreis, neu in Betrieb nehmen oder kp senken"
                )
            }
            Fault::EncoderStep { motor, seen, limit } => {
                let motor = motor_name(motor);
                say!(
                    l,
                    fault,
                    "{motor} 的光栅在一个周期内跳变 {seen} 个计数，最多可能为 {limit}：检查电缆和读数头",
                    "Der Maßstab von {motor} sprang in einem Takt um {seen} Schritte, höchstens {limit} sind möglich: Kabel und Lesekopf prüfen"
                )
            }
            Fault::GantrySkew { seen_um, limit_um } => say!(
                l,
                fault,
                "龙门偏斜 {seen_um:.0} µm，限值 {limit_um:.0}：两个 X 驱动已关闭；下次运动前请先校正",
                "Das Portal steht {seen_um:.0} µm schief, die Grenze ist {limit_um:.0}: beide X-Antriebe sind aus; vor der nächsten Bewegung ausrichten"
            ),
            Fault::LimitSwitch { motor, positive } => {
                let (motor, end) = (motor_name(motor), end(positive));
                say!(
                    l,
                    fault,
                    "{motor} 的 {end} 限位开关被压下；复位后回参考点：搜索会离开该开关",
                    "Endschalter {end} von {motor} ist gedrückt; zurücksetzen und referenzieren: die Suche führt von ihm weg"
                )
            }
            Fault::MarkNotFound { motor } => {
                let motor = motor_name(motor);
                say!(
                    l,
                    fault,
                    "未找到 {motor} 的参考标记；检查读数头和搜索距离",
                    "Keine Referenzmarke von {motor} gefunden; Lesekopf und Suchweg prüfen"
                )
            }
            Fault::SoftLimit { axis, position } => {
                let axis = axis_name(axis);
                say!(
                    l,
                    fault,
                    "轨迹超出 {axis} 的行程（{position:.3}）",
                    "Die Bahn verlässt den Verfahrweg von {axis} ({position:.3})"
                )
            }
            Fault::NoSolution { line, s_mm } => say!(
                l,
                fault,
                "第 {line} 行：机器无法沿轨迹到达 s = {s_mm:.3} mm：该处运动学无解",
                "Zeile {line}: die Maschine kann der Bahn bis s = {s_mm:.3} mm nicht folgen: die Kinematik hat dort keine Lösung"
            ),
            Fault::Jump { axis, distance, s_mm } => {
                let axis = axis_name(axis);
                say!(
                    l,
                    fault,
                    "轨迹要求 {axis} 在 s = {s_mm:.3} mm 处跳变 {distance:.3} mm（或 °）；请避开奇异点和半圈翻转",
                    "Die Bahn verlangt von {axis} bei s = {s_mm:.3} mm einen Sprung um {distance:.3} mm (oder °); von Polen und halben Drehungen fernhalten"
                )
            }
            Fault::LinkLost { silent_ms } => say!(
                l,
                fault,
                "机器运动时 PC 静默 {silent_ms} ms，已停机；检查连接后复位",
                "Der PC schwieg {silent_ms} ms, während die Maschine fuhr; sie wurde angehalten: Verbindung prüfen, dann zurücksetzen"
            ),
            Fault::SessionEnded => say!(
                l,
                fault,
                "机器运动时 PC 会话结束，已停机；检查 PC 及其电缆后复位",
                "Die Verbindung des PC endete, während die Maschine fuhr; sie wurde angehalten: PC und Kabel prüfen, dann zurücksetzen"
            ),
            Fault::Unattended { seconds } => say!(
                l,
                fault,
                "{seconds} 秒内没有 PC 连接：驱动已关闭；连接后复位",
                "{seconds} s lang war kein PC verbunden: die Antriebe wurden abgeschaltet; verbinden, dann zurücksetzen"
            ),
            Fault::NotLocked { side, s_mm, why } => {
                let (beam, why) = (side + 1, self.no_permit(why));
                say!(
                    l,
                    fault,
                    "光束 {beam} 应在 s = {s_mm:.1} mm 处打开，但{why}：检查摄像机和照明，或加长引入段",
                    "Strahl {beam} sollte bei s = {s_mm:.1} mm angehen, aber {why}: Kamera und Licht prüfen oder der Bahn einen längeren Einlauf geben"
                )
            }
            Fault::PermitLost { side, s_mm, why } => {
                let (beam, why) = (side + 1, self.no_permit(why));
                say!(
                    l,
                    fault,
                    "光束 {beam} 在 s = {s_mm:.1} mm 处关闭，机器已停止，因为{why}",
                    "Strahl {beam} wurde bei s = {s_mm:.1} mm abgeschaltet und die Maschine angehalten; Grund: {why}"
                )
            }
            Fault::NoAnswer {
                input,
                line,
                within_ms,
            } => {
                let (input, line) = (input + 1, self.line(usize::from(line)));
                say!(
                    l,
                    fault,
                    "{line} 打开时，输入 {input} 未在 {within_ms} ms 内到来，机器已停止：检查其信号来源和电缆",
                    "Eingang {input} kam nicht innerhalb von {within_ms} ms, während {line} an war; die Maschine wurde angehalten: nachsehen, was er meldet, und sein Kabel prüfen"
                )
            }
            Fault::NotANumber => say!(
                l,
                fault,
                "控制律得到了非数值；检查机器参数",
                "Ein Regler erhielt einen Wert, der keine Zahl ist; Maschinenparameter prüfen"
            ),
            Fault::ReferencesLate => say!(
                l,
                fault,
                "轨迹任务连续两次或 100 ms 内三次迟到；伺服环没有给定值",
                "Die Bahnaufgabe kam zweimal hintereinander oder dreimal in 100 ms zu spät; den Lageregelkreisen fehlten Sollwerte"
            ),
            Fault::NoMovement { motor, commanded_um } => {
                let motor = motor_name(motor);
                say!(
                    l,
                    fault,
                    "已指令 {motor} 移动 {commanded_um:.0} µm（或 m°），但光栅没有变化：检查光栅及其电缆、驱动器和制动器，以及驱动器零偏",
                    "Der Antrieb von {motor} sollte um {commanded_um:.0} µm (oder m°) fahren, aber der Maßstab bewegte sich nicht: Maßstab und Kabel, Antrieb und Bremse und den Offset des Antriebs prüfen"
                )
            }
            Fault::StopTooLong { limit_ms } => say!(
                l,
                fault,
                "停止指令后 {limit_ms} ms 机器仍未静止：驱动已关闭；请报告此情况",
                "Die Maschine stand {limit_ms} ms nach dem Haltebefehl noch nicht: die Antriebe wurden abgeschaltet; bitte melden"
            ),
            Fault::BeyondTravel { axis, position } => {
                let axis = axis_name(axis);
                say!(
                    l,
                    fault,
                    "{axis} 位于 {position:.3}，超出行程和停止距离；检查其驱动器和光栅",
                    "{axis} steht bei {position:.3}, jenseits von Verfahrweg und Anhalteweg; Antrieb und Maßstab prüfen"
                )
            }
        }
    }

    /// A fault of the tracker board.
    pub fn tracker_fault(self, fault: &TrackerFault) -> String {
        let l = self.0;
        let slide_name = |slide: u8| SLIDE_NAMES[usize::from(slide)];
        match *fault {
            TrackerFault::EmergencyStop => self.emergency_stop(fault),
            TrackerFault::EmergencyStopChannels { closed } => self.channels(fault, closed),
            TrackerFault::Drive { slide } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "滑台 {slide} 的驱动器报告故障；请查看驱动器上的显示",
                    "Der Antrieb von Schlitten {slide} meldet eine Störung; am Antrieb selbst nachsehen"
                )
            }
            TrackerFault::LimitSwitch { slide, positive } => {
                let (slide, end) = (slide_name(slide), end(positive));
                say!(
                    l,
                    fault,
                    "滑台 {slide} 的 {end} 限位开关被压下",
                    "Endschalter {end} von Schlitten {slide} ist gedrückt"
                )
            }
            TrackerFault::MarkNotFound { slide } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "未找到滑台 {slide} 的参考标记",
                    "Keine Referenzmarke von Schlitten {slide} gefunden"
                )
            }
            TrackerFault::SeamNotSeen { side, s_mm } => {
                let beam = side + 1;
                say!(
                    l,
                    fault,
                    "光束 {beam} 在 s = {s_mm:.1} mm 处打开，但其摄像机尚未看到焊缝：检查摄像机和照明，或加长引入段",
                    "Strahl {beam} ist bei s = {s_mm:.1} mm an, aber seine Kamera hat die Naht noch nicht gesehen: Kamera und Licht prüfen oder der Bahn einen längeren Einlauf geben"
                )
            }
            TrackerFault::LostSeam { side, s_mm } => {
                let side = side + 1;
                say!(
                    l,
                    fault,
                    "第 {side} 侧在 s = {s_mm:.1} mm 处丢失焊缝",
                    "Seite {side} hat die Naht bei s = {s_mm:.1} mm verloren"
                )
            }
            TrackerFault::BesideSeam { slide, off_mm, s_mm } => {
                let (beam, slide) = (slide / 2 + 1, slide_name(slide));
                say!(
                    l,
                    fault,
                    "光束 {beam} 在 s = {s_mm:.1} mm 处关闭：此后光斑可能偏离焊缝 {off_mm:.2} mm（{slide}）：焊缝跳变、弯曲过急或不可见；检查该处焊缝，降低速度，或检查摄像机和照明",
                    "Strahl {beam} ging bei s = {s_mm:.1} mm aus: von dort an kann der Spot {off_mm:.2} mm neben der Naht liegen ({slide}): die Naht springt, biegt zu scharf ab oder ist nicht zu sehen; dort nachsehen, langsamer fahren oder Kamera und Licht prüfen"
                )
            }
            TrackerFault::Saturated { slide, ms } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "滑台 {slide} 处于速度极限达 {ms} ms",
                    "Schlitten {slide} war {ms} ms lang an seiner Geschwindigkeitsgrenze"
                )
            }
            TrackerFault::SoftLimit { slide, position_mm } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "跟踪时滑台 {slide} 到达软限位（{position_mm:.2} mm）",
                    "Schlitten {slide} ist beim Folgen an seiner Softwaregrenze ({position_mm:.2} mm)"
                )
            }
            TrackerFault::SessionEnded => say!(
                l,
                fault,
                "滑台运动时 PC 会话结束；检查 PC 及其电缆后复位",
                "Die Verbindung des PC endete, während die Schlitten fuhren; PC und Kabel prüfen, dann zurücksetzen"
            ),
            TrackerFault::Unattended { seconds } => say!(
                l,
                fault,
                "{seconds} 秒内没有 PC 连接：滑台驱动已关闭；连接后复位",
                "{seconds} s lang war kein PC verbunden: die Antriebe der Schlitten wurden abgeschaltet; verbinden, dann zurücksetzen"
            ),
            TrackerFault::PathStale { silent_ms } => say!(
                l,
                fault,
                "跟踪时运动板静默 {silent_ms} ms",
                "Die Bewegungskarte schwieg beim Folgen {silent_ms} ms"
            ),
            TrackerFault::FollowingError {
                slide,
                seen_um,
                limit_um,
            } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "滑台 {slide} 偏离指令位置 {seen_um:.0} µm，限值 {limit_um:.0}：检查编码器、驱动器、滑台和 preview_s；然后复位并回参考点",
                    "Schlitten {slide} ist {seen_um:.0} µm von der befohlenen Stelle entfernt, die Grenze ist {limit_um:.0}: Geber, Antrieb, Schlitten und preview_s prüfen; dann zurücksetzen und referenzieren"
                )
            }
            TrackerFault::EncoderStep { slide, seen, limit } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "滑台 {slide} 的编码器在一个周期内跳变 {seen} 个计数，最多可能为 {limit}：检查电缆和读数头；然后复位并回参考点",
                    "Der Geber von Schlitten {slide} sprang in einem Takt um {seen} Schritte, höchstens {limit} sind möglich: Kabel und Lesekopf prüfen; dann zurücksetzen und referenzieren"
                )
            }
            TrackerFault::Overspeed {
                slide,
                seen_mm_s,
                limit_mm_s,
            } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "滑台 {slide} 速度达 {seen_mm_s:.0} mm/s，限值 {limit_mm_s:.0}：检查驱动器和编码器比例；然后复位并回参考点",
                    "Schlitten {slide} fuhr {seen_mm_s:.0} mm/s, die Grenze ist {limit_mm_s:.0}: Antrieb und Skalierung des Gebers prüfen; dann zurücksetzen und referenzieren"
                )
            }
            TrackerFault::NoMovement { slide, commanded_um } => {
                let slide = slide_name(slide);
                say!(
                    l,
                    fault,
                    "已指令滑台 {slide} 移动 {commanded_um:.0} µm，但编码器没有变化：检查编码器及其电缆、驱动器和制动器，以及驱动器零偏；然后复位并回参考点",
                    "Schlitten {slide} sollte um {commanded_um:.0} µm fahren, aber sein Geber bewegte sich nicht: Geber und Kabel, Antrieb und Bremse und den Offset des Antriebs prüfen; dann zurücksetzen und referenzieren"
                )
            }
        }
    }

    fn emergency_stop(self, fault: impl ToString) -> String {
        say!(
            self.0,
            fault,
            "急停按钮被按下；松开后复位",
            "Not-Halt ist gedrückt; lösen, dann zurücksetzen"
        )
    }

    fn channels(self, fault: impl ToString, closed: u8) -> String {
        let (closed, open) = (closed + 1, 2 - closed);
        say!(
            self.0,
            fault,
            "急停通道 {closed} 保持闭合而通道 {open} 已断开：断开的通道断线，或另一通道触点粘连或被短接；修复后完全按下按钮、松开，再复位",
            "Not-Halt-Kanal {closed} blieb geschlossen, während Kanal {open} offen war: die Leitung des offenen ist unterbrochen, oder der Kontakt des anderen verschweißt oder überbrückt; beheben, den Taster ganz drücken, lösen, dann zurücksetzen"
        )
    }

    fn no_permit(self, why: NoPermit) -> String {
        match why {
            NoPermit::Silent => say!(
                self.0,
                why,
                "未收到跟踪板的任何信息",
                "von der Trackerkarte kommt nichts"
            ),
            NoPermit::Refused => say!(self.0, why, "跟踪板不允许", "die Trackerkarte erlaubt es nicht"),
            NoPermit::NotOnSeam => say!(
                self.0,
                why,
                "其滑台尚未到达焊缝",
                "ihre Schlitten sind noch nicht auf der Naht"
            ),
            NoPermit::Outdated => say!(
                self.0,
                why,
                "跟踪板只回答机床先前的位置：现在的信息丢失、迟到，或变化快于滑台所能（如轴在振动）",
                "die Trackerkarte antwortet nur auf frühere Orte der Maschine: was sie jetzt erfährt, ging verloren, kommt zu spät oder \
                 springt schneller, als ihre Schlitten können, wie bei Achsen, die schwingen"
            ),
        }
    }

    /// A beam or an output of the process, by the index of its line; in English the fault's own sentence names it.
    fn line(self, line: usize) -> String {
        match (line.checked_sub(SIDES), self.0) {
            (_, Language::English) => String::new(),
            (None, Language::Chinese) => format!("光束 {}", line + 1),
            (None, Language::German) => format!("Strahl {}", line + 1),
            (Some(output), Language::Chinese) => format!("输出 {}", output + 1),
            (Some(output), Language::German) => format!("Ausgang {}", output + 1),
        }
    }
}

/// An end of an axis.
fn end(positive: bool) -> &'static str {
    if positive { "+" } else { "−" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_has_its_evidence_in_every_language() {
        let fault = Fault::FollowingError {
            motor: 2,
            seen_um: 512.0,
            limit_um: 500.0,
        };
        for language in Language::ALL {
            let said = Words(language).fault(&fault);
            assert!(
                ["Y", "512", "500"].iter().all(|part| said.contains(part)),
                "{said}"
            );
        }
        assert_eq!(Words(Language::English).fault(&fault), fault.to_string());
        let lost = Fault::PermitLost {
            side: 1,
            s_mm: 31.25,
            why: NoPermit::Silent,
        };
        let german = Words(Language::German).fault(&lost);
        assert!(
            german.starts_with("Strahl 2 ") && german.ends_with("von der Trackerkarte kommt nichts"),
            "{german}"
        );
    }
}

//! Everything that the screen says, in every language: one table, in which no text can be missing.
//!
//! Sentences of the planner, of the NC interpreter and of reports (reasons for a refusal, notices, figures) come as they are, in
//! English: they name files, lines and values, and are the same in logs and reports.

mod faults;
mod happened;

use config::parameters::Change;
use host_link::events::{Next, Phase, Question};
use serde::{Deserialize, Serialize};
use shared::state::State;

/// A language of the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Language {
    /// English.
    #[default]
    #[serde(rename = "en")]
    English,
    /// Simplified Chinese.
    #[serde(rename = "zh-Hans")]
    Chinese,
    /// German.
    #[serde(rename = "de")]
    German,
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 3] = [Self::English, Self::Chinese, Self::German];

    /// Its own name.
    pub fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Chinese => "中文",
            Self::German => "Deutsch",
        }
    }

    /// Its tag after BCP 47.
    pub fn tag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Chinese => "zh-Hans",
            Self::German => "de",
        }
    }
}

/// Makes the table: a name, and the text in English, Chinese and German. `{}` stands for what is put in, in order.
macro_rules! texts {
    ($($name:ident: $english:literal, $chinese:literal, $german:literal;)*) => {
        /// A text of the screen.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "the texts say what they are")]
        pub enum Text { $($name,)* }

        impl Text {
            /// All texts.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The text in `language`.
            pub fn in_language(self, language: Language) -> &'static str {
                match (self, language) {
                    $((Self::$name, Language::English) => $english,
                      (Self::$name, Language::Chinese) => $chinese,
                      (Self::$name, Language::German) => $german,)*
                }
            }
        }
    };
}

texts! {
    // Pages
    Run: "Run", "运行", "Lauf";
    LivePlot: "Live plot", "实时曲线", "Messkurven";
    Alarms: "Alarms", "报警", "Alarme";
    Welds: "Welds", "焊缝记录", "Nähte";
    Settings: "Screen", "屏幕", "Anzeige";
    Parameters: "Parameters", "参数", "Parameter";
    // Always in sight
    Stop: "STOP", "停止", "STOPP";
    StopHint: "F1 or Esc: beams off, stop on the path", "F1 或 Esc：关束并沿轨迹停止", "F1 oder Esc: Strahlen aus, Halt auf der Bahn";
    NoJob: "no job", "无任务", "kein Auftrag";
    NotConnected: "boards not connected", "控制板未连接", "keine Verbindung zu den Karten";
    Silent: "No word from the boards for {} s", "控制板已 {} 秒无应答", "Seit {} s keine Antwort der Karten";
    BeamOn: "BEAM ON", "光束开", "STRAHL AN";
    // States of the motion board
    StateOff: "drives off", "驱动关闭", "Antriebe aus";
    StateHoming: "homing", "回参考点", "Referenzfahrt";
    StateIdle: "at rest", "静止", "in Ruhe";
    StateRunning: "moving", "运动中", "in Bewegung";
    StateHolding: "held", "保持", "angehalten";
    StateStopping: "stopping", "正在停止", "hält an";
    StateFault: "fault", "故障", "Störung";
    // Phases of a job
    SettingUp: "setting up the boards", "设置控制板", "Karten einrichten";
    SearchingMarks: "searching reference marks", "寻找参考标记", "Referenzmarken suchen";
    RelatingClocks: "relating the clocks", "时钟对齐", "Uhren abgleichen";
    Approaching: "approaching", "接近工件", "Anfahren";
    RunningIn: "running in", "引入段", "Einlauf";
    SearchingSeam: "searching the seam", "寻找焊缝", "Naht suchen";
    Welding: "welding", "焊接中", "Schweißen";
    MovingOn: "moving on", "移至下一段", "weiter";
    Probing: "probing", "接触测量", "Antasten";
    Dwelling: "dwelling", "暂停计时", "Verweilen";
    WaitingForInput: "waiting for input {} (line {})", "等待输入 {}（第 {} 行）", "wartet auf Eingang {} (Zeile {})";
    AtLine: "line {}", "第 {} 行", "Zeile {}";
    TeachingPoint: "teaching point {} of {}", "示教第 {} 点，共 {} 点", "Punkt {} von {} lernen";
    TeachingSeam: "teaching point {}", "示教第 {} 点", "Punkt {} lernen";
    Calibrating: "calibrating, place {} of {}", "标定第 {} 处，共 {} 处", "Kalibrieren, Stelle {} von {}";
    Exciting: "exciting {}, {} of {}", "激励 {}，{}/{}", "{} anregen, {} von {}";
    Parking: "parking", "回停放位", "Parken";
    Stopping: "stopping", "正在停止", "hält an";
    // What the machine waits for
    GoOn: "Waiting before {}. Resume continues.", "在{}前等待。按“继续”。", "Wartet vor {}. „Weiter“ setzt fort.";
    NextApproach: "the next move of the approach", "下一段接近", "der nächsten Anfahrt";
    NextParking: "parking", "回停放位", "dem Parken";
    NextLine: "line {}", "第 {} 行", "Zeile {}";
    ProgramStop: "Line {}: stopped by {}{}. Resume continues.", "第 {} 行：{} 停止{}。按“继续”。", "Zeile {}: Halt durch {}{}. „Weiter“ setzt fort.";
    ToolIn: "Line {}: put tool {} in{}, then Resume.", "第 {} 行：装入刀具 {}{}，然后按“继续”。", "Zeile {}: Werkzeug {} einsetzen{}, dann „Weiter“.";
    ToolOut: "Line {}: take the tool out{}, then Resume.", "第 {} 行：取出刀具{}，然后按“继续”。", "Zeile {}: Werkzeug herausnehmen{}, dann „Weiter“.";
    FeedTooLow: "Held: the feed is too low for the beam. Raise the override, then Resume.", "已保持：进给过低，不能开束。请提高倍率，然后按“继续”。", "Angehalten: Vorschub zu klein für den Strahl. Override erhöhen, dann „Weiter“.";
    JogAsked: "The job asks where to jog.", "任务询问点动位置。", "Der Auftrag fragt nach einer Handfahrt.";
    // Run page
    Load: "Load…", "载入…", "Laden…";
    Loading: "Reading, planning and predicting…", "正在读取、规划并预测…", "Lesen, planen, vorhersagen…";
    NoProgram: "No program is loaded. Load one to begin.", "未载入程序。请先载入程序。", "Kein Programm geladen. Zum Beginnen eines laden.";
    NoProgramThere: "No program is loaded.", "未载入程序。", "Kein Programm geladen.";
    ChooseProgram: "Programs in {}", "{} 中的程序", "Programme in {}";
    NoPrograms: "There are no programs in this folder.", "此文件夹中没有程序。", "In diesem Ordner sind keine Programme.";
    Cancel: "Cancel", "取消", "Abbrechen";
    Start: "Start…", "启动…", "Start…";
    StartNow: "Weld now", "现在焊接", "Jetzt schweißen";
    StartTitle: "Ready to weld?", "准备焊接？", "Bereit zum Schweißen?";
    StartWarning: "Drives go on, the axes search their marks, beams will be switched by the program. Is nobody in the cell?", "驱动将接通，各轴寻找参考标记，光束由程序控制。防护区内无人？", "Antriebe gehen an, Achsen suchen ihre Marken, das Programm schaltet die Strahlen. Ist niemand in der Zelle?";
    FromLine: "from line {}", "从第 {} 行", "ab Zeile {}";
    FromBeginning: "from the beginning", "从头开始", "von Anfang an";
    FirstMove: "First it moves to {}", "首先移动到 {}", "Zuerst fährt sie nach {}";
    Hold: "Hold", "保持", "Halt";
    Resume: "Resume", "继续", "Weiter";
    Back: "Back", "回退", "Zurück";
    SingleBlock: "Single block", "单段", "Einzelsatz";
    Override: "Feed override", "进给倍率", "Vorschub-Override";
    Speed: "Speed", "速度", "Geschwindigkeit";
    Power: "Power", "功率", "Leistung";
    Remaining: "Remaining", "剩余", "Restzeit";
    Predicted: "Predicted", "预计", "Vorhersage";
    Along: "Along the seam", "沿焊缝", "Entlang der Naht";
    Line: "Line", "行", "Zeile";
    Way: "Path and tool", "轨迹与工具", "Bahn und Werkzeug";
    Deviation: "Spot beside its seam, as the tracker goes by [µm]", "光斑相对焊缝的偏差（跟踪板依据）[µm]", "Spot neben der Naht, wonach der Tracker geht [µm]";
    Limit: "limit ±{} µm", "限值 ±{} µm", "Grenze ±{} µm";
    Camera: "Camera {}", "摄像机 {}", "Kamera {}";
    NoPicture: "no picture yet", "暂无图像", "noch kein Bild";
    SeamSeen: "SEAM", "焊缝", "NAHT";
    SeamNotSeen: "NO SEAM", "无焊缝", "KEINE NAHT";
    Across: "across {} mm", "横向 {} mm", "quer {} mm";
    Height: "height {} mm", "高度 {} mm", "Höhe {} mm";
    Gap: "gap {} mm", "间隙 {} mm", "Spalt {} mm";
    // The end of a job
    Finished: "Finished: within all limits", "完成：全部在限值内", "Fertig: in allen Grenzen";
    FinishedOutside: "Finished, OUTSIDE its limits", "完成，但超出限值", "Fertig, AUSSERHALB der Grenzen";
    EndedEarly: "Ended early", "提前结束", "Vorzeitig beendet";
    ReportIn: "Report in {}", "报告位于 {}", "Bericht in {}";
    WrongFile: "Not loaded", "未载入", "Nicht geladen";
    // Alarms
    StoppedByOperator: "stopped by the operator; beams are off and the machine is at rest", "操作员已停止；光束关闭，机器静止", "vom Bediener gestoppt; die Strahlen sind aus, die Maschine steht";
    NoAlarms: "No alarms.", "无报警。", "Keine Alarme.";
    Acknowledge: "Acknowledge", "确认", "Quittieren";
    History: "What happened", "事件记录", "Verlauf";
    Connected: "boards connected: {}", "控制板已连接：{}", "Karten verbunden: {}";
    JobFinished: "job finished", "任务完成", "Auftrag fertig";
    // Live plot
    Freeze: "Freeze", "冻结", "Einfrieren";
    Export: "Export CSV", "导出 CSV", "CSV ausgeben";
    Exported: "Written to {}", "已写入 {}", "Geschrieben nach {}";
    TriggerOn: "Freeze when", "触发条件：", "Einfrieren, wenn";
    RisesAbove: "rises above", "升至高于", "steigt über";
    Arm: "Arm", "准备触发", "Scharf";
    CursorHint: "Tap the curves to set cursors A and B.", "点按曲线以放置光标 A 和 B。", "Kurven antippen, um Marken A und B zu setzen.";
    NoSignals: "Signals appear once a job runs.", "任务运行后显示信号。", "Signale erscheinen, sobald ein Auftrag läuft.";
    Signals: "Signals", "信号", "Signale";
    Window: "Window", "时间窗", "Fenster";
    Seconds: "{} s", "{} 秒", "{} s";
    SignalSpeed: "path speed", "轨迹速度", "Bahngeschwindigkeit";
    SignalSkew: "gantry skew", "龙门偏斜", "Gantry-Schieflage";
    SignalBeam: "beam {}", "光束 {}", "Strahl {}";
    SignalPower: "power {}", "功率 {}", "Leistung {}";
    SignalSlide: "slide {}", "滑台 {}", "Schlitten {}";
    SignalSlideError: "{} beside its target", "{} 偏离目标", "{} neben dem Ziel";
    SignalFollowingError: "following error {}", "跟随误差 {}", "Schleppfehler {}";
    SignalAxis: "axis {}", "轴 {}", "Achse {}";
    // Welds
    NoWelds: "There are no reports in {} yet.", "{} 中还没有报告。", "In {} sind noch keine Berichte.";
    Figure: "Figure", "指标", "Größe";
    MayBe: "May be", "允许", "Erlaubt";
    Compare: "Compare with", "对比", "Vergleichen mit";
    Duration: "Duration", "用时", "Dauer";
    TrueDeviation: "Spot beside its seam, in truth (only a simulated machine can know it) [µm]", "光斑相对焊缝的真实偏差（仅仿真机可知）[µm]", "Spot neben der Naht, in Wahrheit (nur eine simulierte Maschine weiß sie) [µm]";
    Outside: "OUTSIDE", "超限", "ÜBER";
    // Setting up
    SetUp: "Set up", "调整", "Einrichten";
    Home: "Home…", "回零…", "Referenz…";
    HomeNow: "Home now", "立即回零", "Jetzt referenzieren";
    HomeTitle: "Switch the drives on and home?", "接通驱动并回零？", "Antriebe einschalten und referenzieren?";
    HomeWarning: "The drives go on, and every axis searches its reference mark, in the sequence of the machine file. Keep clear of the machine.", "驱动将接通，各轴按机器文件中的顺序寻找参考点。请远离机器。", "Die Antriebe gehen an, und jede Achse sucht ihre Referenzmarke in der Reihenfolge der Maschinendatei. Abstand von der Maschine halten.";
    DrivesOff: "Drives off", "断开驱动", "Antriebe aus";
    ProgramRuns: "A program runs: nothing can be set up meanwhile.", "程序正在运行：此时不能调整。", "Ein Programm läuft: solange kann nichts eingerichtet werden.";
    WorkOffsets: "Work offsets…", "工件偏置…", "Nullpunkte…";
    WorkOffsetsTitle: "Work offsets", "工件偏置", "Nullpunktverschiebungen";
    WorkOffsetsHint: "Where the origin of each coordinate system lies, for programs that call it and for blocks by hand. Programs planned from a part are not moved by it.", "各坐标系原点的位置，用于调用该坐标系的程序和手动程序段。由工件规划的程序不受其影响。", "Wo der Ursprung jedes Koordinatensystems liegt, für Programme, die es aufrufen, und für Sätze von Hand. Aus einem Teil geplante Programme werden davon nicht verschoben.";
    Origin: "Origin", "原点", "Ursprung";
    TipIn: "Tip in {}", "{} 中的刀尖", "Spitze in {}";
    TurnAboutZ: "Turn about Z", "绕 Z 旋转", "Drehung um Z";
    Value: "Value", "数值", "Wert";
    OriginIs: "Set origin to value", "将原点设为数值", "Ursprung auf Wert";
    SeamIn: "Seam {} in {}, by its camera", "焊缝 {}（摄像机测得）在 {} 中", "Naht {} in {}, nach ihrer Kamera";
    SeamIs: "Set seam {} to value", "将焊缝 {} 设为数值", "Naht {} auf Wert";
    NoSeamInPicture: "no seam in the picture", "图像中没有焊缝", "keine Naht im Bild";
    TipIs: "Set tip here to value", "将此处刀尖设为数值", "Spitze hier auf Wert";
    NotAnOffset: "Not a number from -100000 to 100000.", "不是 -100000 到 100000 之间的数。", "Keine Zahl von -100000 bis 100000.";
    Save: "Save", "保存", "Speichern";
    SetToValue: "Set to value", "设为数值", "Auf Wert setzen";
    Tools: "Tools…", "刀具…", "Werkzeuge…";
    ToolsTitle: "Tools", "刀具", "Werkzeuge";
    ToolsHint: "In {}: how far the end of each tool is beyond the tip of the machine file, for G43, and its diameter, for G41 and G42.", "在 {} 中：各刀具端点超出机器文件中工具尖点的长度（用于 G43），以及刀具直径（用于 G41 和 G42）。", "In {}: wie weit das Ende jedes Werkzeugs über die Spitze der Maschinendatei hinausreicht, für G43, und sein Durchmesser, für G41 und G42.";
    ToolLength: "Length", "长度", "Länge";
    ToolDiameter: "Diameter", "直径", "Durchmesser";
    NoTools: "There are no tools: H and D in programs change nothing. For a first one, type its number and tap “New tool with this number”.", "没有刀具：程序中的 H 和 D 不起作用。要添加刀具，请输入其编号，然后点按“以此编号新建刀具”。", "Es gibt keine Werkzeuge: H und D in Programmen ändern nichts. Für das erste seine Nummer eingeben und „Neues Werkzeug mit dieser Nr.“ antippen.";
    NewTool: "New tool with this number", "以此编号新建刀具", "Neues Werkzeug mit dieser Nr.";
    NotInSet: "Not in this set. A tap puts it in so that it does next to nothing until it is changed:", "该组中没有。点一下即加入，更改之前几乎不起作用：", "Nicht in diesem Satz. Getippt kommt es hinein, so dass es kaum etwas tut, bis es geändert wird:";
    NewWeldData: "New set with this name", "以此名称新建一组", "Neuer Satz mit diesem Namen";
    RemoveWeldData: "Take set out", "删除该组", "Satz herausnehmen";
    RemoveTool: "Take tool out", "删除刀具", "Werkzeug herausnehmen";
    ToolsWithDrivesOff: "Tools are changed while the drives are off.", "刀具数据须在驱动断开时更改。", "Werkzeuge werden bei ausgeschalteten Antrieben geändert.";
    WeldData: "Weld data…", "焊接数据…", "Schweißdaten…";
    WeldDataTitle: "Weld data", "焊接数据", "Schweißdaten";
    WeldDataHint: "In {}, beside the program, which calls the sets by WELDON. A new set begins as a copy of the one that is chosen. Levels and pins are added in the file.", "在程序旁的 {} 中，程序用 WELDON 调用各组数据。新组先复制所选的组。模拟输出和搅拌针的数据在文件中添加。", "In {} neben dem Programm, das die Sätze mit WELDON aufruft. Ein neuer Satz beginnt als Kopie des gewählten. Pegel und Stifte werden in der Datei ergänzt.";
    NoWeldData: "There are no sets yet. Type a name, root for example, and make the first: of no power, which WELDON=root calls. All keys are in docs/files.md; a set can be, for example:", "尚无数据。请输入名称（例如 root），新建第一组：功率为零，程序用 WELDON=root 调用。所有项目见 docs/files.md，例如：", "Es gibt noch keine Sätze. Tippen Sie einen Namen ein, zum Beispiel root, und legen Sie den ersten an: ohne Leistung, WELDON=root ruft ihn auf. Alle Schlüssel stehen in docs/files.md; ein Satz kann zum Beispiel so sein:";
    Sharpness: "Sharpness {}, best {}", "清晰度 {}，最佳 {}", "Schärfe {}, beste {}";
    Defocus: "Out of focus by {} mm, + is towards the camera", "离焦 {} mm，+ 为靠近摄像机", "Außer Fokus um {} mm, + ist zur Kamera hin";
    DefocusUnknown: "Sharp, but no seam to measure", "有清晰带，但没有可测的焊缝", "Scharf, aber keine Naht zu messen";
    FocusTooHigh: "The work is too near the camera", "工件离摄像机太近", "Das Werkstück ist zu nah an der Kamera";
    FocusTooLow: "The work is too far from the camera", "工件离摄像机太远", "Das Werkstück ist zu weit von der Kamera";
    NothingSharp: "Nothing is sharp", "没有清晰部分", "Nichts ist scharf";
    Positions: "Positions", "位置", "Positionen";
    TipOfTool: "Tip in the work", "工具尖点（工件坐标）", "Spitze im Werkstück";
    NotHomed: "The drives are off: home first.", "驱动已断开：请先回零。", "Die Antriebe sind aus: zuerst referenzieren.";
    References: "Reference marks", "参考点", "Referenzmarken";
    DrivesComeOn: "The drives are coming on.", "驱动正在接通。", "Die Antriebe gehen an.";
    SearchesNow: "{} search now.", "{} 正在寻找。", "{} suchen jetzt.";
    WaitsForOthers: "{} search now; {} wait for their turn.", "{} 正在寻找；{} 等待其顺序。", "{} suchen jetzt; {} warten, bis sie an der Reihe sind.";
    ArmPanel: "Arm the panel", "启用点动面板", "Bedienfeld scharf schalten";
    Armed: "ARMED: the machine moves by these buttons. Tap to disarm.", "已启用：按钮会使机器运动。点按可停用。", "SCHARF: diese Tasten bewegen die Maschine. Antippen schaltet ab.";
    FrameAxes: "Axes", "轴", "Achsen";
    FrameWork: "Work", "工件", "Werkstück";
    FrameTool: "Tool", "工具", "Werkzeug";
    FrameSlides: "Slides", "滑台", "Schlitten";
    Step: "Step", "步长", "Schritt";
    Continuous: "While held", "按住时", "Gehalten";
    JogSpeed: "Speed", "速度", "Tempo";
    JogKeys: "Keys, while armed: arrows for the first two directions, Page up and Page down for the third", "启用后按键：方向键控制前两个方向，Page Up / Page Down 控制第三个方向", "Tasten, wenn scharf: Pfeile für die ersten beiden Richtungen, Bild auf und Bild ab für die dritte";
    BlockByHand: "Block by hand (MDI), checked as a program is; the panel must be armed", "手动程序段（MDI），按程序同样检查；须先启用面板", "Satz von Hand (MDI), geprüft wie ein Programm; das Bedienfeld muss scharf sein";
    CarryOut: "Carry out", "执行", "Ausführen";
    // Teaching
    Teach: "Teach", "示教", "Lernen";
    ChoosePart: "Part…", "工件…", "Teil…";
    ChoosePartIn: "Choose a part in {}", "在 {} 中选择工件", "Teil in {} wählen";
    NoParts: "There is no part to be taught there ([seam], [t-seam]).", "那里没有可示教的工件（[seam]、[t-seam]）。", "Dort ist kein Teil, das gelernt wird ([seam], [t-seam]).";
    NoPart: "Choose a part whose seam goes through taught places, or whose seams the cameras see. What is taught goes to its file at once.", "请选择由示教点定义焊缝或由摄像机识别焊缝的工件。示教结果会立即写入其文件。", "Ein Teil wählen, dessen Naht durch gelernte Punkte geht oder dessen Nähte die Kameras sehen. Was gelernt ist, steht sofort in seiner Datei.";
    HomeFirst: "Home on the page Set up first.", "请先在“调整”页面回零。", "Zuerst auf der Seite Einrichten referenzieren.";
    Take: "Take", "记录", "Übernehmen";
    Undo: "Undo", "撤销", "Zurücknehmen";
    PlanProgram: "Plan program", "规划程序", "Programm planen";
    Restart: "Begin anew…", "重新开始…", "Neu beginnen…";
    RestartTitle: "Take out all places?", "删除所有点？", "Alle Punkte herausnehmen?";
    RestartKeeps: "They are kept as a version of the file.", "它们会作为文件的一个版本保留。", "Sie bleiben als Version der Datei erhalten.";
    RestartNow: "Take out", "删除", "Herausnehmen";
    Taken: "Place {} is taken.", "已记录第 {} 点。", "Punkt {} ist übernommen.";
    TakenAlready: "This place is taken already.", "该点已记录。", "Dieser Punkt ist schon übernommen.";
    Undone: "Taken out.", "已删除。", "Herausgenommen.";
    Planned: "{} is planned, and is being loaded.", "{} 已规划，正在加载。", "{} ist geplant und wird geladen.";
    PlacesIn: "Places in {}: X Y Z mm, A B C °", "{} 中的点：X Y Z mm，A B C °", "Punkte in {}: X Y Z mm, A B C °";
    TeachSeams: "Teach…", "示教…", "Lernen…";
    TeachSeamsTitle: "Teach the seams of {} with the cameras?", "用摄像机示教 {} 的焊缝？", "Die Nähte von {} mit den Kameras lernen?";
    TeachSeamsWarning: "The drives go on and the machine homes. With the beams off, the cameras search the seams where they are drawn to begin, and follow them to their end; then the machine parks. Everything must be free to move. Is nobody in the cell?", "驱动将接通并回零。光束关闭，摄像机在图纸的焊缝起点处寻找焊缝，并跟随到终点，然后机器回停放位。所有运动部件必须无阻碍。防护区内无人？", "Die Antriebe gehen an, die Maschine referenziert. Bei ausgeschalteten Strahlen suchen die Kameras die Nähte, wo sie laut Zeichnung beginnen, und folgen ihnen bis zum Ende, dann parkt die Maschine. Alles muss frei beweglich sein. Ist niemand in der Zelle?";
    TeachSeamsNow: "Teach now", "立即示教", "Jetzt lernen";
    GoesOnAfter: "It goes on after point {}.", "从第 {} 点之后继续。", "Es geht nach Punkt {} weiter.";
    EndLesson: "End after this point", "本点之后结束", "Nach dem Punkt enden";
    PointsIn: "{} points in {}", "{} 个点，保存在 {}", "{} Punkte in {}";
    DrivesOffFirst: "Switch the drives off on the page Set up first.", "请先在“调整”页面断开驱动。", "Zuerst auf der Seite Einrichten die Antriebe ausschalten.";
    Jogging: "jogging", "点动", "Handfahrt";
    ByHandAsked: "Ready to jog, or for a block", "可点动或执行程序段", "Bereit für Handfahrt oder Satz";
    // Parameters
    Search: "Search", "搜索", "Suchen";
    AllParameters: "All", "全部", "Alle";
    ChangedParameters: "Changed ({})", "已更改（{}）", "Geändert ({})";
    OtherThanShipped: "Other than shipped", "与出厂值不同", "Anders als ausgeliefert";
    Unit: "Unit", "单位", "Einheit";
    Shipped: "Shipped", "出厂值", "Ausgeliefert";
    ParameterRange: "Range", "范围", "Bereich";
    RangeUnsaid: "told when it is refused", "超出范围时提示", "wird bei Ablehnung genannt";
    InFile: "In the file", "文件中的值", "In der Datei";
    ChooseParameter: "Choose a parameter from the list to see and change it.", "请从列表中选择参数，以查看和更改。", "Einen Parameter aus der Liste wählen, um ihn zu sehen und zu ändern.";
    NoParameters: "Nothing matches.", "没有匹配项。", "Nichts gefunden.";
    SetValue: "Set", "设定", "Setzen";
    TakeBack: "Take back", "撤回", "Zurücknehmen";
    NotANumber: "Must be a number, such as 12.5", "必须是数字，例如 12.5", "Muss eine Zahl sein, etwa 12.5";
    NotWhole: "Must be a whole number", "必须是整数", "Muss eine ganze Zahl sein";
    NotAValue: "Must be written as in the file, such as true or [1.0, 2.0]", "须按文件中的格式书写，例如 true 或 [1.0, 2.0]", "Muss wie in der Datei geschrieben sein, etwa true oder [1.0, 2.0]";
    Changes: "Changes, not written yet", "更改（尚未写入）", "Änderungen, noch nicht geschrieben";
    NoChanges: "None.", "无。", "Keine.";
    OnlyComments: "No value differs, only comments or layout.", "数值相同，仅注释或排版不同。", "Kein Wert ist anders, nur Kommentare oder Anordnung.";
    ParameterChange: "{}: {} → {}", "{}：{} → {}", "{}: {} → {}";
    LeftOut: "left out", "未给出", "weggelassen";
    Refused: "Refused: {}", "被拒绝：{}", "Abgelehnt: {}";
    Write: "Write…", "写入…", "Schreiben…";
    WriteNow: "Write now", "立即写入", "Jetzt schreiben";
    WriteTitle: "Write these changes to {}?", "将这些更改写入 {}？", "Diese Änderungen in {} schreiben?";
    WriteKeeps: "What is there now is kept as {}.", "当前内容将保存为 {}。", "Was jetzt darin steht, bleibt als {} erhalten.";
    WriteThen: "The program is planned anew, and the next job runs with these values.", "程序将重新规划，下一个任务使用这些数值。", "Das Programm wird neu geplant, und der nächste Auftrag läuft mit diesen Werten.";
    Weakened: "A protection becomes weaker: {}", "保护减弱：{}", "Ein Schutz wird schwächer: {}";
    WriteAtRest: "A job runs or a program is being loaded: writing waits until then.", "任务正在运行或程序正在载入，结束后才能写入。", "Ein Auftrag läuft oder ein Programm wird geladen: Geschrieben wird erst danach.";
    Discard: "Discard", "放弃", "Verwerfen";
    StaleFile: "The file on the disk has changed since it was loaded. It is not written over.", "磁盘上的文件在载入后已被更改，不会被覆盖。", "Die Datei auf der Platte ist seit dem Laden geändert worden. Sie wird nicht überschrieben.";
    OtherMachine: "The loaded program was planned before the file was changed on the disk. Load it again.", "已载入的程序是在磁盘文件更改之前规划的，请重新载入。", "Das geladene Programm ist geplant worden, bevor die Datei auf der Platte geändert wurde. Neu laden.";
    LoadAnew: "Discard and load anew", "放弃更改并重新载入", "Verwerfen und neu laden";
    Versions: "Backups…", "备份…", "Sicherungen…";
    VersionsOf: "Backups of {}", "{} 的备份", "Sicherungen von {}";
    VersionsHint: "The file as it was before each write, newest first. A tap lists what would change; nothing is written by it.", "每次写入前的文件，最新的在前。点按会列出更改，不会写入。", "Die Datei vor jedem Schreiben, die neueste zuerst. Antippen listet auf, was sich ändern würde; geschrieben wird dabei nichts.";
    NoVersions: "There are none yet.", "尚无备份。", "Es gibt noch keine.";
    VersionDiffers: "{}: {} other values", "{}：{} 个数值不同", "{}: {} andere Werte";
    ChangesFirst: "Write or discard the changes first.", "请先写入或放弃更改。", "Zuerst die Änderungen schreiben oder verwerfen.";
    FileMade: "{} made", "已新建 {}", "{} angelegt";
    FileWritten: "{} written; what was there before is in {}", "已写入 {}；原内容在 {}", "{} geschrieben; der vorige Inhalt ist in {}";
    // Commissioning
    Commission: "Commission", "调试", "Abgleich";
    Motors: "Motors: tick those to be measured", "电机：勾选要测量的电机", "Motoren: zu messende ankreuzen";
    MotorNotMeasured: "not measured", "未测量", "nicht gemessen";
    MotorMeasured: "measured", "已测量", "gemessen";
    MotorOlder: "measured before the file was changed", "测量早于文件更改", "gemessen, bevor die Datei geändert wurde";
    MotorWritten: "written", "已写入", "geschrieben";
    MotorRefused: "left as it is", "保持不变", "bleibt, wie er ist";
    MotorUnreadable: "cannot be read", "无法读取", "nicht lesbar";
    Evaluating: "What was measured is being evaluated…", "正在分析测量结果…", "Die Messungen werden ausgewertet…";
    Measure: "Measure…", "测量…", "Messen…";
    MeasureNow: "Measure now", "立即测量", "Jetzt messen";
    MeasureTitle: "Measure {}?", "测量 {}？", "{} messen?";
    MeasureWarning: "The drives go on and the machine homes. Each motor is then moved as told below, and at last the machine parks. Everything must be free to move. Is nobody in the cell?", "驱动将接通并回零。随后各电机按下列方式运动，最后机器回停放位。所有运动部件必须无阻碍。防护区内无人？", "Die Antriebe gehen an, die Maschine referenziert. Dann wird jeder Motor bewegt wie unten gesagt, zuletzt parkt die Maschine. Alles muss frei beweglich sein. Ist niemand in der Zelle?";
    MeasureMoves: "{}: {} times {} there and back, shaken by up to {}; then {} to both sides", "{}：往返 {} 次，每次 {}，叠加最大 {} 的激励；然后向两侧各摆动 {}", "{}: {} mal {} hin und zurück, dabei bis {} gerüttelt; dann {} nach beiden Seiten";
    MeasureLasts: "It takes about {} min after homing. Meanwhile all loops have a quarter of their gain.", "回零后约需 {} 分钟。期间所有位置环的增益降至四分之一。", "Es dauert nach dem Referenzieren etwa {} min. Solange haben alle Regelkreise ein Viertel ihrer Verstärkung.";
    CommissionAtRest: "A job runs or a program is being loaded: commissioning waits until then.", "任务正在运行或程序正在载入，结束后才能调试。", "Ein Auftrag läuft oder ein Programm wird geladen: Erst danach wird in Betrieb genommen.";
    EndedWith: "It ended early: {}", "提前结束：{}", "Vorzeitig beendet: {}";
    ChooseMotor: "Choose a motor from the list to see what was found of it.", "请从列表中选择电机，以查看结果。", "Einen Motor aus der Liste wählen, um zu sehen, was gefunden wurde.";
    MeasureFirst: "It was not measured yet. Tick it and measure it.", "尚未测量。请勾选并测量。", "Er ist noch nicht gemessen. Ankreuzen und messen.";
    MeasuredAt: "measured {}", "测量时间 {}", "gemessen {}";
    BeforeLoop: "before", "之前", "vorher";
    NowLoop: "now", "现在", "jetzt";
    LoopGain: "kp [1/s]", "kp [1/s]", "kp [1/s]";
    GainMargin: "gain margin [dB]", "增益裕度 [dB]", "Amplitudenreserve [dB]";
    PhaseMargin: "phase margin [°]", "相位裕度 [°]", "Phasenreserve [°]";
    Sensitivity: "sensitivity, peak", "灵敏度峰值", "Empfindlichkeit, Spitze";
    Crossover: "crossover [Hz]", "穿越频率 [Hz]", "Durchtritt [Hz]";
    DriveFound: "drive: gain {}, delay {} ms", "驱动：增益 {}，延迟 {} ms", "Antrieb: Verstärkung {}, Verzug {} ms";
    GainHeld: "the margins allow more gain, a machine file does not: {}", "裕度允许更高的增益，但机器文件不允许：{}", "die Reserven lassen mehr Verstärkung zu, eine Maschinendatei nicht: {}";
    NotchFound: "notch at {} Hz, damping {}, depth {}", "陷波 {} Hz，阻尼 {}，深度 {}", "Kerbfilter bei {} Hz, Dämpfung {}, Tiefe {}";
    NoNotch: "no notch is worth its lag", "陷波滤波无益", "kein Kerbfilter lohnt sich";
    FrictionFound: "friction: {} {}, turned round at {} {}", "摩擦：{} {}，换向速度 {} {}", "Reibung: {} {}, gewendet bei {} {}";
    FrictionLeft: "friction stays as it is: {}", "摩擦保持不变：{}", "Reibung bleibt: {}";
    VerdictSwings: "With the values of before this loop swings by itself.", "按原来的数值，该位置环会自激振荡。", "Mit den Werten von vorher schwingt dieser Regelkreis von selbst.";
    VerdictTooLittle: "With the values of before this loop has too little margin: it rings, and swings if a resonance moves.", "按原来的数值，该位置环裕度不足：会振铃，共振变化时会振荡。", "Mit den Werten von vorher hat dieser Regelkreis zu wenig Reserve: er klingt nach und schwingt, wenn sich eine Resonanz verschiebt.";
    VerdictEnough: "With the values of before this loop has its margins; with what was found its gain is {} times as high.", "按原来的数值，该位置环裕度足够；采用新数值后增益为原来的 {} 倍。", "Mit den Werten von vorher hat dieser Regelkreis seine Reserven; mit den gefundenen ist seine Verstärkung {} mal so hoch.";
    DoWrite: "Write what was found; then check it with a circle and a dry weld.", "请写入结果，然后用圆度测试和无光束试焊检查。", "Das Gefundene schreiben, dann mit einem Kreis und einer Naht ohne Strahl prüfen.";
    DoCheck: "It is in the machine file. Check it with a circle and a dry weld.", "已写入机器文件。请用圆度测试和无光束试焊检查。", "Es steht in der Maschinendatei. Mit einem Kreis und einer Naht ohne Strahl prüfen.";
    DoMeasureAgain: "The machine file has other values of this motor since it was measured. What was found is for these; if anything of drive or mechanics was changed too, measure again.", "测量之后机器文件中该电机的数值已更改。结果按现有数值计算；若驱动或机械也有变动，请重新测量。", "Die Maschinendatei hat seit der Messung andere Werte dieses Motors. Das Gefundene gilt für diese; ist auch am Antrieb oder an der Mechanik etwas geändert, neu messen.";
    DoFreeMotor: "Look for friction, play, a loose coupling, a brake that is not open, and at the signal of the grating; then measure again.", "请检查摩擦、间隙、松动的联轴器、未松开的制动器以及光栅信号，然后重新测量。", "Nach Reibung, Spiel, loser Kupplung, geschlossener Bremse und dem Signal des Messsystems sehen; dann neu messen.";
    DoLookAtPlot: "Look at the plot: where a resonance stands out at a low frequency, stiffen or damp it, or lower the limits of the drive's own filters; then measure again.", "请查看曲线：若低频处有突出的共振，请加强刚度或阻尼，或检查驱动自身的滤波器，然后重新测量。", "Die Kurven ansehen: wo bei niedriger Frequenz eine Resonanz heraussteht, versteifen oder dämpfen, auch die Filter des Antriebs prüfen; dann neu messen.";
    DoCorrect: "Correct the value on the page Parameters, then look here again.", "请在“参数”页面更正该数值，然后再查看此处。", "Den Wert auf der Seite Parameter berichtigen, dann hier wieder nachsehen.";
    DoMendIt: "See to what is named, then measure again.", "请先处理上述问题，然后重新测量。", "Das Genannte beheben, dann neu messen.";
    DoRepeat: "Measure it again.", "请重新测量。", "Neu messen.";
    SpeedForCommand: "Measured: speed for a command, gain [dB]", "实测：速度/指令，增益 [dB]", "Gemessen: Geschwindigkeit zu Befehl, Betrag [dB]";
    SpeedPhase: "phase [°]", "相位 [°]", "Phase [°]";
    CoherenceCurve: "coherence: grey is not believed", "相干性：灰色部分不可信", "Kohärenz: Graues wird nicht geglaubt";
    OpenLoopGain: "Open loop, before and now: gain [dB]", "开环，之前与现在：增益 [dB]", "Offener Kreis, vorher und jetzt: Betrag [dB]";
    OpenLoopPhase: "phase [°]; vertical lines: margins", "相位 [°]；竖线为裕度", "Phase [°]; senkrechte Striche: Reserven";
    OfMotors: "Of these motors:", "写入以下电机：", "Von diesen Motoren:";
    CameraToSpot: "Camera to spot", "摄像机与光斑", "Kamera zu Spot";
    SpotHint: "Where a camera looks beside its spot goes into every weld. It is found by two marks that both beams burn into a bare plate, before where the program that is loaded begins to weld.", "摄像机与光斑的偏移会直接带入每条焊缝。两束激光在空白板上各烧一条标记，位置为已载入程序开始焊接处之前，由此测得该偏移。", "Wohin eine Kamera neben ihren Spot sieht, geht in jede Naht ein. Gefunden wird es an zwei Marken, die beide Strahlen in ein blankes Blech brennen, dort, wo das geladene Programm zu schweißen beginnt.";
    MarkPower: "Power [W]", "功率 [W]", "Leistung [W]";
    MarkLength: "Length of a mark [mm]", "标记长度 [mm]", "Länge einer Marke [mm]";
    NotAMark: "The power must be above 0, and the length from {} to {} mm.", "功率必须大于 0，长度必须为 {} 至 {} mm。", "Die Leistung muss über 0 sein, die Länge von {} bis {} mm.";
    Burn: "Burn marks…", "烧标记…", "Marken brennen…";
    BurnNow: "Burn now", "立即烧", "Jetzt brennen";
    BurnTitle: "Burn marks for camera {}?", "为摄像机 {} 烧标记？", "Marken für Kamera {} brennen?";
    BurnWarning: "BOTH BEAMS BURN with {} W: two marks of {} mm, one behind the other, from where {} begins to weld on. A bare, level plate has to lie there at the height of the seams, {} mm long, and nothing else may be in the way of heads and camera. The machine homes, goes there, burns, and passes over the marks with the beams off. Everybody must be protected from the beams.", "两束激光将以 {} W 出光：烧两条 {} mm 的标记，前后排列，从 {} 开始焊接处起。该处须在焊缝高度放置一块水平的空白板，长 {} mm，焊头和摄像机的路径上不得有其他物体。机床回零、到达该处、烧标记，然后关光经过标记。所有人必须受到激光防护。", "BEIDE STRAHLEN BRENNEN mit {} W: zwei Marken von {} mm hintereinander, von dort an, wo {} zu schweißen beginnt. Dort muss ein blankes, waagrechtes Blech auf der Höhe der Nähte liegen, {} mm lang, und sonst nichts im Weg von Köpfen und Kamera sein. Die Maschine referenziert, fährt hin, brennt und fährt mit Strahlen aus über die Marken. Alle müssen vor den Strahlen geschützt sein.";
    NoSpotYet: "No spot was found yet since the screen was opened.", "屏幕打开后尚未测得光斑。", "Seit die Anzeige offen ist, wurde noch kein Spot gefunden.";
    SpotMoved: "Since the calibration before, the spot has moved by {} µm in U and {} µm in V.", "与先前的标定相比，光斑在 U 方向移动了 {} µm，在 V 方向移动了 {} µm。", "Seit der Kalibrierung davor ist der Spot um {} µm in U und {} µm in V gewandert.";
    CalibrationWrite: "Write calibration…", "写入标定…", "Kalibrierung schreiben…";
    WriteCalibration: "The calibration of camera {}, with what was found in it.", "摄像机 {} 的标定，含测得的数值。", "Die Kalibrierung der Kamera {} mit dem, was gefunden wurde.";
    CalibrationUnnamed: "The machine file names no calibrations yet. This one goes to {} beside it; once both are there, put calibration = [\"camera-1.toml\", \"camera-2.toml\"] under [cameras] in the machine file.", "机床文件尚未指定标定文件。此标定将写入其旁的 {}；两台都完成后，在机床文件的 [cameras] 下添加 calibration = [\"camera-1.toml\", \"camera-2.toml\"]。", "Die Maschinendatei nennt noch keine Kalibrierungen. Diese kommt nach {} daneben; sind beide da, gehört calibration = [\"camera-1.toml\", \"camera-2.toml\"] unter [cameras] in die Maschinendatei.";
    CircularTest: "Circular test", "圆度测试", "Kreistest";
    GoRound: "Go round…", "走圆…", "Kreis fahren…";
    GoRoundNow: "Go round now", "立即走圆", "Jetzt fahren";
    GoRoundTitle: "Go round? {}", "开始走圆？{}", "Kreis fahren? {}";
    CircleOf: "{} mm in {} at {} m/min", "{} mm，{} 平面，{} m/min", "{} mm in {} mit {} m/min";
    GoRoundWarning: "The drives go on and the machine homes. With the beams off, the tool goes to the circle, one and a half turns there and as many back, and the machine parks. Everything must be free to move. Is nobody in the cell?", "驱动将接通并回零。光束关闭，刀具移至圆上，正转一圈半、反转一圈半，然后机器回停放位。所有运动部件必须无阻碍。防护区内无人？", "Die Antriebe gehen an, die Maschine referenziert. Bei ausgeschalteten Strahlen fährt das Werkzeug zum Kreis, anderthalb Umläufe hin und ebenso viele zurück, dann parkt die Maschine. Alles muss frei beweglich sein. Ist niemand in der Zelle?";
    CirclePlane: "Plane", "平面", "Ebene";
    CircleRadius: "Radius [mm]", "半径 [mm]", "Radius [mm]";
    CircleSpeed: "Speed [m/min]", "速度 [m/min]", "Geschwindigkeit [m/min]";
    CircleWithin: "Limit [mm] (empty: none)", "限值 [mm]（可留空）", "Grenze [mm] (leer: keine)";
    CircleFigures: "{}: from the circle {} mm, G {} mm, mean radius {} mm", "{}：距圆 {} mm，G {} mm，平均半径偏差 {} mm", "{}: vom Kreis {} mm, G {} mm, mittlerer Radius {} mm";
    CircleReversals: "reversals [mm]: {}", "换向处 [mm]：{}", "Umkehrpunkte [mm]: {}";
    CircleBoth: "both directions: G(b) {} mm", "双向：G(b) {} mm", "beide Richtungen: G(b) {} mm";
    CircleInside: "Within the limit of {} mm.", "在 {} mm 限值内。", "Innerhalb der Grenze von {} mm.";
    CircleOutside: "OUTSIDE the limit of {} mm. Look where: spikes behind reversals are friction, steps of both directions play, waves a loop with too little margin.", "超出 {} mm 限值。请看位置：换向后的尖峰为摩擦，双向台阶为间隙，波纹为裕度不足的位置环。", "AUSSERHALB der Grenze von {} mm. Wo? Spitzen hinter Umkehrpunkten sind Reibung, Stufen zwischen beiden Richtungen Spiel, Wellen ein Kreis mit zu wenig Reserve.";
    CircleRound: "Magnified: {} µm are a quarter of the radius", "放大：{} µm 为半径的四分之一", "Vergrößert: {} µm sind ein Viertel des Radius";
    CircleOverAngle: "Outwards [µm] over the angle [°]", "向外偏差 [µm]，随角度 [°]", "Nach außen [µm] über dem Winkel [°]";
    NoCircleYet: "No circle was made yet since the screen was opened.", "屏幕打开后尚未走圆。", "Seit die Anzeige offen ist, wurde noch kein Kreis gefahren.";
    NotALength: "Radius and speed must be numbers above 0, and so must a limit.", "半径、速度及限值必须是大于 0 的数字。", "Radius und Geschwindigkeit müssen Zahlen über 0 sein, eine Grenze ebenso.";
    // The screen itself
    LanguageChoice: "Language", "语言", "Sprache";
    Contrast: "High contrast", "高对比度", "Hoher Kontrast";
    KeysOnScreen: "Keys to type with on the screen", "屏幕按键输入", "Tasten zum Tippen auf dem Bildschirm";
    LeftHanded: "Stop and controls on the left", "停止与控制在左侧", "Stopp und Bedienung links";
    Size: "Size of everything", "整体大小", "Größe von allem";
    Machine: "Machine", "机器", "Maschine";
    Boards: "Boards", "控制板", "Karten";
    Keys: "Keys: F1 or Esc stops, F2 holds, Tab and Enter reach every button, Ctrl and a digit the pages", "按键：F1 或 Esc 停止，F2 保持，Tab 与回车可操作所有按钮，Ctrl+数字键切换页面", "Tasten: F1 oder Esc stoppt, F2 hält an, Tab und Enter erreichen jede Taste, Strg und eine Ziffer die Seiten";
    Version: "Version {}", "版本 {}", "Version {}";
    // Viewers
    Served: "Viewers", "观看者", "Zuschauer";
    ServedAt: "Address", "地址", "Adresse";
    ServedToken: "Token", "令牌", "Token";
    ServedPage: "In a browser", "浏览器", "Im Browser";
    NoPageServed: "there is no page for browsers: cargo xtask browser makes it", "没有浏览器页面：用 cargo xtask browser 生成", "es gibt keine Seite für Browser: cargo xtask browser macht sie";
    ServedFingerprint: "Certificate, SHA-256", "证书 SHA-256", "Zertifikat, SHA-256";
    ServedTo: "{} of {} watch", "正在观看：{}/{}", "{} von {} sehen zu";
    NotServed: "nobody can watch: opened without --serve", "无法观看：启动时未用 --serve", "niemand kann zusehen: ohne --serve geöffnet";
    Watching: "WATCHING", "仅观看", "NUR ANSICHT";
    WatchingHint: "This screen shows {} and commands nothing. Stop is at the machine.", "此屏幕仅显示 {}，不能操作。停止按钮在机器旁。", "Diese Anzeige zeigt {} und bedient nichts. Stopp ist an der Maschine.";
    NoConnection: "No connection: {}", "无连接：{}", "Keine Verbindung: {}";
    Connecting: "Connecting to {}…", "正在连接 {}…", "Verbindung zu {}…";
    ShownIsOld: "What is shown is {} s old", "显示内容已过时 {} 秒", "Das Gezeigte ist {} s alt";
    WatchingKeys: "Keys: Tab and Enter reach every button, Ctrl and a digit the pages", "按键：Tab 与回车可操作所有按钮，Ctrl+数字键切换页面", "Tasten: Tab und Enter erreichen jede Taste, Strg und eine Ziffer die Seiten";
    // Access
    Operator: "operator", "操作员", "Bediener";
    Setter: "setter", "调机员", "Einrichter";
    Engineer: "engineer", "工程师", "Ingenieur";
    LevelNow: "Access level", "权限级别", "Zugriffsstufe";
    NoPinSet: "No PIN is set: everybody may do everything. The engineer's PIN is set first.", "未设置 PIN：任何人均可进行所有操作。请先设置工程师的 PIN。", "Keine PIN gesetzt: Jeder darf alles. Zuerst wird die des Ingenieurs gesetzt.";
    PinsUnreadable: "The settings file cannot be read and may hold PINs: no more than what an operator may until it is set right.", "设置文件无法读取，其中可能有 PIN：修正之前只允许操作员的操作。", "Die Einstellungsdatei ist nicht lesbar und enthält vielleicht PINs: bis sie berichtigt ist, nur was ein Bediener darf.";
    AccessAsked: "Access…", "权限…", "Zugriff…";
    LockScreen: "Lock", "锁定", "Sperren";
    NeedsLevel: "Needs the access level: {}", "需要权限级别：{}", "Braucht die Zugriffsstufe: {}";
    SetPinOf: "Set PIN: {}…", "设置 PIN：{}…", "PIN setzen: {}…";
    TakePinAway: "Remove PIN: {}", "删除 PIN：{}", "PIN entfernen: {}";
    EnterPin: "Enter the PIN", "输入 PIN", "PIN eingeben";
    NewPin: "New PIN: {}", "新 PIN：{}", "Neue PIN: {}";
    NewPinHint: "4 to 8 digits", "4 至 8 位数字", "4 bis 8 Ziffern";
    PinAgain: "The same PIN again", "再次输入相同的 PIN", "Dieselbe PIN noch einmal";
    PinsDiffer: "These were two different PINs. Once more from the beginning.", "两次输入的 PIN 不同。请重新输入。", "Das waren zwei verschiedene PINs. Noch einmal von vorn.";
    WrongPin: "This PIN is wrong.", "PIN 错误。", "Diese PIN ist falsch.";
    WaitForPin: "Too many wrong PINs: wait {} s.", "PIN 错误次数过多：请等待 {} 秒。", "Zu viele falsche PINs: {} s warten.";
    NotAPin: "A PIN has 4 to 8 digits.", "PIN 为 4 至 8 位数字。", "Eine PIN hat 4 bis 8 Ziffern.";
    PinTaken: "Another level has this PIN.", "此 PIN 已用于其他级别。", "Eine andere Stufe hat diese PIN.";
    EngineerFirst: "The engineer's PIN is set first, and removed last.", "工程师的 PIN 须最先设置、最后删除。", "Die PIN des Ingenieurs wird zuerst gesetzt und zuletzt entfernt.";
    NoRandomness: "The system gives no random numbers: the PIN is not set.", "系统无法提供随机数：PIN 未设置。", "Das System gibt keine Zufallszahlen: Die PIN ist nicht gesetzt.";
    DeleteDigit: "Delete", "删除", "Löschen";
    EnterDigits: "OK", "确定", "OK";
    LevelEntered: "access level entered: {}", "已进入权限级别：{}", "Zugriffsstufe betreten: {}";
    ScreenLocked: "screen locked", "屏幕已锁定", "Anzeige gesperrt";
    LevelFellBack: "screen locked: untouched for 10 minutes", "屏幕已锁定：10 分钟无操作", "Anzeige gesperrt: 10 Minuten lang nicht berührt";
    WrongPinEntered: "wrong PIN", "PIN 错误", "falsche PIN";
    PinSet: "PIN set: {}", "已设置 PIN：{}", "PIN gesetzt: {}";
    PinTakenAway: "PIN removed: {}", "已删除 PIN：{}", "PIN entfernt: {}";
    // What outlives the screen
    EarlierHistory: "Earlier, before the screen was opened", "更早（屏幕打开之前）", "Früher, bevor die Anzeige geöffnet wurde";
    RecordUnwritten: "What happens is not being recorded: {}", "事件未能记录到文件：{}", "Der Verlauf wird nicht aufgezeichnet: {}";
    SettingsUnread: "Settings not read: {}. Set the file right, or delete it, and open the screen again; until then nothing is written to it.", "设置未读取：{}。请修正或删除该文件，然后重新打开屏幕；在此之前不会写入该文件。", "Einstellungen nicht gelesen: {}. Die Datei berichtigen oder löschen und die Anzeige neu öffnen; bis dahin wird nichts hineingeschrieben.";
    SettingsUnwritten: "Settings not kept: {}", "设置未保存：{}", "Einstellungen nicht gesichert: {}";
}

/// A language, to say things in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Words(pub Language);

impl Words {
    /// A text.
    pub fn say(self, text: Text) -> &'static str {
        text.in_language(self.0)
    }

    /// A text with what is put in.
    pub fn with(self, text: Text, put_in: &[&str]) -> String {
        let mut put_in = put_in.iter();
        let mut pieces = self.say(text).split("{}");
        let mut said = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            said.push_str(put_in.next().copied().unwrap_or_default());
            said.push_str(piece);
        }
        said
    }

    /// A part of a job.
    pub fn phase(self, phase: Phase) -> String {
        let text = match phase {
            Phase::SettingUp => Text::SettingUp,
            Phase::Homing => Text::SearchingMarks,
            Phase::RelatingClocks => Text::RelatingClocks,
            Phase::Approaching => Text::Approaching,
            Phase::RunningIn => Text::RunningIn,
            Phase::SearchingSeam => Text::SearchingSeam,
            Phase::Welding => Text::Welding,
            Phase::MovingOn => Text::MovingOn,
            Phase::Probing => Text::Probing,
            Phase::Dwelling => Text::Dwelling,
            Phase::Parking => Text::Parking,
            Phase::Jogging => Text::Jogging,
            Phase::Stopping => Text::Stopping,
            Phase::WaitingForInput { number, line } => {
                return self.with(Text::WaitingForInput, &[&number.to_string(), &line.to_string()]);
            }
            Phase::Line(line) => return self.with(Text::AtLine, &[&line.to_string()]),
            Phase::TeachingPoint { number, of } => {
                return self.with(Text::TeachingPoint, &[&number.to_string(), &of.to_string()]);
            }
            Phase::TeachingSeam { number } => return self.with(Text::TeachingSeam, &[&number.to_string()]),
            Phase::Calibrating { place, of } => {
                return self.with(Text::Calibrating, &[&place.to_string(), &of.to_string()]);
            }
            Phase::Exciting { motor, number, of } => {
                return self.with(Text::Exciting, &[motor, &number.to_string(), &of.to_string()]);
            }
        };
        self.say(text).to_owned()
    }

    /// What the machine waits for.
    pub fn question(self, question: &Question) -> String {
        let said = |text: &Option<String>| {
            text.as_ref()
                .map_or_else(String::new, |text| format!(" ({text})"))
        };
        match question {
            Question::GoOn { next } => {
                let next = match next {
                    Next::Line(line) => self.with(Text::NextLine, &[&line.to_string()]),
                    Next::Approach => self.say(Text::NextApproach).to_owned(),
                    Next::Parking => self.say(Text::NextParking).to_owned(),
                };
                self.with(Text::GoOn, &[&next])
            }
            Question::Stop { code, line, text } => {
                self.with(Text::ProgramStop, &[&line.to_string(), code, &said(text)])
            }
            Question::Tool { tool: 0, line, text } => {
                self.with(Text::ToolOut, &[&line.to_string(), &said(text)])
            }
            Question::Tool { tool, line, text } => {
                self.with(Text::ToolIn, &[&line.to_string(), &tool.to_string(), &said(text)])
            }
            Question::FeedTooLow => self.say(Text::FeedTooLow).to_owned(),
            Question::ByHand => self.say(Text::ByHandAsked).to_owned(),
            Question::Jog => self.say(Text::JogAsked).to_owned(),
        }
    }

    /// Another value of a parameter.
    pub fn change(self, change: &Change) -> String {
        let value = |value: &Option<String>| {
            value
                .clone()
                .unwrap_or_else(|| self.say(Text::LeftOut).to_owned())
        };
        let (old, new) = (value(&change.old), value(&change.new));
        self.with(Text::ParameterChange, &[&change.key, &old, &new])
    }

    /// A state of the motion board.
    pub fn state(self, state: State) -> &'static str {
        self.say(match state {
            State::Off => Text::StateOff,
            State::Homing => Text::StateHoming,
            State::Idle => Text::StateIdle,
            State::Running => Text::StateRunning,
            State::Holding => Text::StateHolding,
            State::Stopping => Text::StateStopping,
            State::Fault => Text::StateFault,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_is_there_in_every_language_and_takes_as_much_as_in_english() {
        for text in Text::ALL {
            let places = |language| text.in_language(language).matches("{}").count();
            for language in Language::ALL {
                assert!(
                    !text.in_language(language).trim().is_empty(),
                    "{text:?} in {language:?}"
                );
                assert_eq!(
                    places(language),
                    places(Language::English),
                    "{text:?} in {language:?}"
                );
            }
        }
    }

    #[test]
    fn what_is_put_in_comes_in_order() {
        let words = Words(Language::German);
        let phase = Phase::Exciting {
            motor: "X1",
            number: 2,
            of: 7,
        };
        assert_eq!(words.phase(phase), "X1 anregen, 2 von 7");
    }
}

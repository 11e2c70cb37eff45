//! Chromium without a window, asked by the protocol of its developer tools.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use emulator::bound_to_parent;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(120);

/// See the module. It is ended when this is dropped.
pub struct Chromium {
    process: Child,
    tools: WebSocket<TcpStream>,
    session: Option<String>,
    calls: u64,
    _profile: tempfile::TempDir,
}

impl Chromium {
    /// With a page of nothing, 1280 × 800. Of certificates that no authority has signed it trusts those with the `public_key`, which is in DER.
    pub fn open(public_key: &[u8]) -> Self {
        let profile = tempfile::tempdir().expect("a folder");
        let pin = BASE64_STANDARD.encode(Sha256::digest(public_key));
        let process = bound_to_parent("chromium")
            .args([
                "--headless=new",
                "--remote-debugging-port=0",
                "--no-first-run",
                "--disable-dev-shm-usage",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--window-size=1280,800",
                // Root has no sandbox. It opens the page of the test alone.
                "--no-sandbox",
            ])
            .arg(format!("--ignore-certificate-errors-spki-list={pin}"))
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("Chromium, which `cargo xtask test --browser` installs");
        let tools = tools(&profile.path().join("DevToolsActivePort"));
        let mut chromium = Self {
            process,
            tools,
            session: None,
            calls: 0,
            _profile: profile,
        };
        let page = chromium.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": page["targetId"], "flatten": true });
        let session = chromium.call("Target.attachToTarget", attach);
        chromium.session = session["sessionId"].as_str().map(str::to_owned);
        chromium.call("Page.enable", json!({}));
        chromium.resize(1280, 800, 1.0);
        chromium
    }

    /// Has the page be of this size \[CSS pixels\], of so many pixels of the screen each.
    pub fn resize(&mut self, width: u32, height: u32, scale: f64) {
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": scale, "mobile": scale > 1.0 });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// Has `script` run in pages before theirs.
    pub fn before_pages(&mut self, script: &str) {
        let source = json!({ "source": script });
        self.call("Page.addScriptToEvaluateOnNewDocument", source);
    }

    /// Opens `url`; what is wrong with it.
    pub fn navigate(&mut self, url: &str) -> Option<String> {
        let answer = self.call("Page.navigate", json!({ "url": url }));
        answer["errorText"].as_str().map(str::to_owned)
    }

    /// Value of an expression, or of the promise that it is.
    pub fn value(&mut self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// What the page looks like.
    pub fn picture(&mut self) -> image::RgbImage {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let png = BASE64_STANDARD.decode(answer["data"].as_str().expect("a picture"));
        let png = png.expect("a picture");
        image::load_from_memory(&png).expect("a picture").to_rgb8()
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.calls += 1;
        let mut call = json!({ "id": self.calls, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            call["sessionId"] = session.as_str().into();
        }
        let call = Message::Text(call.to_string().into());
        self.tools.send(call).expect("Chromium runs");
        loop {
            let Message::Text(text) = self.tools.read().expect("Chromium answers") else {
                continue;
            };
            let mut answer: Value = serde_json::from_str(&text).expect("JSON");
            if answer["id"] == self.calls {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].take();
            }
        }
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The connection to the tools, once `file` says where they are.
fn tools(file: &Path) -> WebSocket<TcpStream> {
    let end = Instant::now() + PATIENCE;
    let (port, path) = loop {
        let told = std::fs::read_to_string(file).unwrap_or_default();
        if let Some((port, path)) = told.split_once('\n') {
            break (port.parse::<u16>().expect("a port"), path.trim().to_owned());
        }
        assert!(Instant::now() < end, "Chromium does not start");
        std::thread::sleep(Duration::from_millis(20));
    };
    let stream = TcpStream::connect(("127.0.0.1", port)).expect("connected");
    stream.set_read_timeout(Some(PATIENCE)).expect("set");
    let url = format!("ws://127.0.0.1:{port}{path}");
    tungstenite::client(url, stream).expect("the tools").0
}

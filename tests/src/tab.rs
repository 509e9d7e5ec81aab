//! A tab of a real browser that stays open, spoken to over the DevTools protocol: for pages that
//! live, where [`browser`](crate::browser) looks at pages that are done.

use std::collections::VecDeque;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tokio_tungstenite::tungstenite::client;
use tokio_tungstenite::tungstenite::protocol::{WebSocket, WebSocketConfig};
use tokio_tungstenite::tungstenite::{Message, client::IntoClientRequest};

/// Longest wait for anything that must come: a machine may be busy with something else.
const PATIENCE: Duration = Duration::from_secs(300);
/// How often the page is asked again.
const AGAIN: Duration = Duration::from_millis(50);
/// How long a click may take to reach its element.
const LATE: Duration = Duration::from_secs(5);

/// A tab. Dropped, its browser ends.
pub struct Tab {
    browser: Child,
    socket: WebSocket<TcpStream>,
    asked: u64,
    complaints: VecDeque<String>,
    _folder: TempDir,
}

impl Tab {
    /// Starts a browser with one empty tab.
    ///
    /// # Panics
    /// Where none is installed, or it does not start.
    pub fn open() -> Self {
        Self::open_with(&["--disable-gpu"])
    }

    /// As [`open`](Self::open), for pages that draw by WebGL; the processor draws.
    ///
    /// # Panics
    /// As [`open`](Self::open).
    pub fn drawing() -> Self {
        Self::open_with(&[
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--ignore-gpu-blocklist",
        ])
    }

    fn open_with(flags: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let profile = folder.path().join("profile");
        let browser = Command::new(machine::chromium().expect("a browser"))
            .args(["--headless=new", "--no-sandbox", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update"])
            .args(["--disable-sync", "--disable-quic", "--disable-dev-shm-usage"])
            // A tab that is not in front is as quick as one that is.
            .args(["--disable-background-timer-throttling", "--disable-renderer-backgrounding"])
            .arg("--disable-backgrounding-occluded-windows")
            .args(flags)
            .arg("--remote-debugging-port=0")
            .arg("--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1")
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .env("HOME", folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let address = page_of(&profile.join("DevToolsActivePort"));
        let request = address.as_str().into_client_request().expect("an address");
        let host = request.uri().authority().expect("a host").as_str().to_owned();
        let stream = TcpStream::connect(host).expect("the browser listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
        let config = WebSocketConfig::default().max_message_size(None).max_frame_size(None);
        let (socket, _) = client::client_with_config(request, stream, Some(config))
            .unwrap_or_else(|error| panic!("the browser takes no questions: {error}"));
        let complaints = VecDeque::new();
        let mut tab = Self { browser, socket, asked: 0, complaints, _folder: folder };
        for domain in ["Page", "Runtime", "Log", "Network"] {
            tab.ask(&format!("{domain}.enable"), &json!({}));
        }
        tab
    }

    /// Goes to a page and waits until it is there.
    ///
    /// # Panics
    /// When it does not come.
    pub fn go(&mut self, url: &str) {
        let begun = self.ask("Page.navigate", &json!({ "url": url }));
        assert!(begun["errorText"].is_null(), "{url}: {begun}");
        let name = url.split('#').next().unwrap_or(url);
        self.until(&format!(
            "location.href.split('#')[0] === '{name}' && document.readyState === 'complete'"
        ));
    }

    /// The window is `width` CSS pixels wide, light or dark.
    ///
    /// # Panics
    /// When the browser does not answer.
    pub fn look(&mut self, width: u32, dark: bool) {
        let size =
            json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false });
        self.ask("Emulation.setDeviceMetricsOverride", &size);
        let scheme = if dark { "dark" } else { "light" };
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.ask("Emulation.setEmulatedMedia", &json!({ "features": features }));
    }

    /// What a JavaScript expression, or a promise of it, comes to.
    ///
    /// # Panics
    /// When it throws.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let question =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.ask("Runtime.evaluate", &question);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    ///
    /// # Panics
    /// When it does not become so; the message has the text of the page.
    pub fn until(&mut self, expression: &str) {
        let began = Instant::now();
        while self.evaluate(&format!("Boolean({expression})")) != Value::Bool(true) {
            if began.elapsed() > PATIENCE {
                let text = self.evaluate("document.body.innerText");
                panic!("never true: {expression}\n{}", text.as_str().unwrap_or_default());
            }
            thread::sleep(AGAIN);
        }
    }

    /// Clicks an element as a person does: when it is there, in sight, at rest and not disabled.
    ///
    /// # Panics
    /// When it does not become so.
    pub fn click(&mut self, selector: &str) {
        // What comes late may move the element between the look and the click: it is asked whether it
        // was clicked. A page that went elsewhere by that knows nothing of it.
        let listen = format!(
            "window.clickReached = false; document.querySelector({selector:?})?.addEventListener(
             'click', () => {{ window.clickReached = true; }}, {{ once: true, capture: true }})"
        );
        let began = Instant::now();
        loop {
            let at = self.middle(selector);
            self.evaluate(&listen);
            self.mouse("mousePressed", at);
            self.mouse("mouseReleased", at);
            // A page at work may come to its clicks later.
            let clicked = Instant::now();
            while clicked.elapsed() < LATE {
                if self.evaluate("window.clickReached !== false") == true {
                    return;
                }
                thread::sleep(AGAIN);
            }
            assert!(began.elapsed() < PATIENCE, "{selector} is not reached by a click");
        }
    }

    /// Presses the mouse on an element and holds it, as [`click`](Self::click) does.
    ///
    /// # Panics
    /// When it does not become ready for it.
    pub fn hold(&mut self, selector: &str) {
        let at = self.middle(selector);
        self.mouse("mousePressed", at);
    }

    /// Lets the mouse go on an element that was [held](Self::hold).
    ///
    /// # Panics
    /// When it does not become ready for it.
    pub fn let_go(&mut self, selector: &str) {
        let at = self.middle(selector);
        self.mouse("mouseReleased", at);
    }

    fn mouse(&mut self, kind: &str, (x, y): (f64, f64)) {
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
        self.ask("Input.dispatchMouseEvent", &event);
    }

    /// The middle of an element in the window, once a click there would reach it. A page that is
    /// still filling moves its elements, and a busy machine gives it the time to.
    fn middle(&mut self, selector: &str) -> (f64, f64) {
        let look = format!(
            "(async () => {{ const one = document.querySelector({selector:?}); if (!one) return null;
             one.scrollIntoView({{ block: 'center', behavior: 'instant' }});
             const place = () => {{ const box = one.getBoundingClientRect();
               return [box.x + box.width / 2, box.y + box.height / 2]; }};
             const frame = () => new Promise((done) => requestAnimationFrame(done));
             const before = place(); await frame(); await frame(); const now = place();
             const hit = document.elementFromPoint(now[0], now[1]);
             const ready = before[0] === now[0] && before[1] === now[1] && !one.disabled
               && one.contains(hit);
             return ready ? now : null; }})()"
        );
        let began = Instant::now();
        loop {
            let found = self.evaluate(&look);
            if let Some(place) = found[0].as_f64().zip(found[1].as_f64()) {
                return place;
            }
            if began.elapsed() > PATIENCE {
                let text = self.evaluate("document.body.innerText");
                panic!("{selector} cannot be clicked\n{}", text.as_str().unwrap_or_default());
            }
            thread::sleep(AGAIN);
        }
    }

    /// Presses a key and lets it go: `Tab`, `Enter`, `Escape`, or a letter.
    ///
    /// # Panics
    /// When the browser does not answer.
    pub fn press(&mut self, key: &str) {
        let code = match key {
            "Tab" => 9,
            "Enter" => 13,
            "Escape" => 27,
            _ => 0,
        };
        let mut event = json!({
            "type": if code == 0 { "keyDown" } else { "rawKeyDown" },
            "key": key, "code": key, "windowsVirtualKeyCode": code,
        });
        match key {
            "Enter" => {
                event["type"] = json!("keyDown");
                event["text"] = json!("\r");
            }
            _ if code == 0 => event["text"] = json!(key),
            _ => {}
        }
        self.ask("Input.dispatchKeyEvent", &event);
        event["type"] = json!("keyUp");
        self.ask("Input.dispatchKeyEvent", &event);
    }

    /// Takes a picture of what is in the window.
    ///
    /// # Panics
    /// When there is none.
    pub fn picture(&mut self, png: &Path) {
        let answer = self.ask("Page.captureScreenshot", &json!({ "format": "png" }));
        let data = answer["data"].as_str().expect("a picture");
        std::fs::write(png, base64(data)).expect("the picture is written");
    }

    /// A picture of the whole page, beyond the window too, in WebP without loss; `scale` times as
    /// large.
    ///
    /// # Panics
    /// When there is none.
    pub fn whole_picture(&mut self, scale: f64) -> Vec<u8> {
        let size = self.evaluate(
            "[document.documentElement.clientWidth, document.documentElement.scrollHeight]",
        );
        let clip = json!({ "x": 0, "y": 0, "width": size[0], "height": size[1], "scale": scale });
        let how = json!({ "format": "png", "captureBeyondViewport": true, "clip": clip });
        let answer = self.ask("Page.captureScreenshot", &how);
        let png = answer["data"].as_str().expect("a picture");
        // The browser itself makes it small.
        let small = self.evaluate(&format!(
            "(async () => {{ const picture = new Image(); picture.src = 'data:image/png;base64,{png}'; await picture.decode();
             const canvas = document.createElement('canvas'); [canvas.width, canvas.height] = [picture.width, picture.height];
             canvas.getContext('2d').drawImage(picture, 0, 0); return canvas.toDataURL('image/webp', 1); }})()"
        ));
        let url = small.as_str().expect("a picture");
        base64(url.split_once(',').expect("an address of data").1)
    }

    /// What the page complained about since this was asked last: script errors, console errors and
    /// warnings, breaches of its policy.
    pub fn complaints(&mut self) -> Vec<String> {
        // An answer shows that all that came before is here.
        self.evaluate("1");
        self.complaints.drain(..).collect()
    }

    /// Asks the browser, and keeps what it complains about meanwhile.
    fn ask(&mut self, method: &str, parameters: &Value) -> Value {
        self.asked += 1;
        let id = self.asked;
        let question = json!({ "id": id, "method": method, "params": parameters });
        self.socket.send(Message::text(question.to_string())).expect("the browser hears");
        loop {
            let said = match self.socket.read() {
                Ok(Message::Text(text)) => text,
                Ok(_) => continue,
                Err(error) => panic!("{method}: the browser has gone: {error}"),
            };
            let said: Value = serde_json::from_str(&said).expect("the browser speaks JSON");
            if said["id"] == id {
                assert!(said["error"].is_null(), "{method}: {}", said["error"]);
                return said["result"].clone();
            }
            self.note(&said);
        }
    }

    fn note(&mut self, said: &Value) {
        let details = &said["params"];
        match said["method"].as_str() {
            Some("Runtime.exceptionThrown") => {
                self.complaints.push_back(details["exceptionDetails"].to_string());
            }
            Some("Log.entryAdded") if details["entry"]["level"] != "verbose" => {
                self.complaints.push_back(details["entry"].to_string());
            }
            Some("Runtime.consoleAPICalled")
                if details["type"] == "error" || details["type"] == "warning" =>
            {
                self.complaints.push_back(details["args"].to_string());
            }
            _ => {}
        }
    }
}

impl Drop for Tab {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.browser.kill();
        let _ = self.browser.wait();
    }
}

/// Where the first tab takes questions.
fn page_of(port_file: &Path) -> String {
    let began = Instant::now();
    loop {
        let told = std::fs::read_to_string(port_file).unwrap_or_default();
        if let Some(port) = told.lines().next().and_then(|line| line.parse::<u16>().ok())
            && let Some(page) = first_page(port)
        {
            return page;
        }
        assert!(began.elapsed() < PATIENCE, "the browser does not start");
        thread::sleep(AGAIN);
    }
}

fn first_page(port: u16) -> Option<String> {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).ok()?;
    stream.set_read_timeout(Some(Duration::from_secs(5))).ok()?;
    let request =
        format!("GET /json/list HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).ok()?;
    let mut answer = String::new();
    // What came counts, however the connection ended.
    let _ = stream.read_to_string(&mut answer);
    let list = answer.get(answer.find('[')?..=answer.rfind(']')?)?;
    let list: Value = serde_json::from_str(list).ok()?;
    let page = list.as_array()?.iter().find(|one| one["type"] == "page")?;
    page["webSocketDebuggerUrl"].as_str().map(str::to_owned)
}

/// Bytes in base64.
pub(crate) fn to_base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |at: usize| u32::from(three.get(at).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// Bytes that are written in base64.
fn base64(text: &str) -> Vec<u8> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => Some(letter - b'A'),
        b'a'..=b'z' => Some(letter - b'a' + 26),
        b'0'..=b'9' => Some(letter - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let (mut bytes, mut bits, mut count) = (Vec::new(), 0_u32, 0);
    for six in text.bytes().filter_map(value) {
        bits = bits << 6 | u32::from(six);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes
}

//! The language server as an editor meets it: over stdin and stdout.

mod client;

use client::Client;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

const MAIN: &str = "import \"parts/column.sdf\"\nparam size = 1 in 0.5..2 \"how large\"\nmaterial gold { color: #d4af37 }\nscene = column(size).twist(y, 0.5) | sphere(size).material(gold)\n";
const COLUMN: &str = "/// A column, round.\nfield column(radius: float) = max(length(p.xz) - radius, abs(p.y) - 1)\n";

fn start(test: &str) -> Client {
    let mut client = Client::start(test, &[("main.sdf", MAIN), ("parts/column.sdf", COLUMN)]);
    client.open("main.sdf", 1, MAIN);
    client
}

/// A text after the edits of an answer.
fn edited(text: &str, edits: &Value) -> String {
    let mut text = text.to_owned();
    let offset = |text: &str, position: &Value| {
        let line = position["line"].as_u64().unwrap() as usize;
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        start + position["character"].as_u64().unwrap() as usize
    };
    let mut edits = edits.as_array().unwrap().clone();
    edits.sort_by_key(|edit| (edit["range"]["start"]["line"].as_u64(), edit["range"]["start"]["character"].as_u64()));
    for edit in edits.iter().rev() {
        let (start, end) = (offset(&text, &edit["range"]["start"]), offset(&text, &edit["range"]["end"]));
        text.replace_range(start..end, edit["newText"].as_str().unwrap());
    }
    text
}

fn messages(diagnostics: &[Value]) -> Vec<&str> {
    diagnostics.iter().map(|told| told["message"].as_str().unwrap().lines().next().unwrap()).collect()
}

#[test]
fn an_editor_asks_and_is_answered() {
    let mut client = start("answers");
    assert_eq!(client.diagnostics("main.sdf", Some(1)), Vec::<Value>::new());
    let here = |client: &Client, words: &str| client.place("main.sdf", Client::at(MAIN, words));

    let found = client.ask("textDocument/completion", here(&client, "twist"));
    let twist = found["items"].as_array().unwrap().iter().find(|item| item["label"] == "twist").unwrap();
    assert_eq!(twist["textEdit"]["newText"], "twist(${1:axis}, ${2:rate})");
    assert!(twist["documentation"]["value"].as_str().unwrap().contains("```sdf"));

    let said = client.ask("textDocument/hover", here(&client, "twist"))["contents"]["value"].as_str().unwrap().to_owned();
    assert!(said.contains("warp twist(axis: vec3, rate: float)") && said.contains("**Factor ×2."), "{said}");
    let said = client.ask("textDocument/hover", here(&client, "size)"))["contents"]["value"].as_str().unwrap().to_owned();
    assert!(said.contains("in 0.5..2 \"how large\""), "{said}");

    let help = client.ask("textDocument/signatureHelp", here(&client, "0.5) |"));
    assert_eq!((&help["signatures"][0]["label"], &help["activeParameter"]), (&json!("warp twist(axis: vec3, rate: float)"), &json!(1)));

    let there = client.ask("textDocument/definition", here(&client, "column(size"));
    assert_eq!(there, json!([{ "uri": client.uri("parts/column.sdf"), "range": { "start": Client::at(COLUMN, "column("), "end": Client::at(COLUMN, "(radius") } }]));
    // The prelude is a file that can be opened, and answers there too.
    let there = client.ask("textDocument/definition", here(&client, "sphere"));
    let prelude = there[0]["uri"].as_str().unwrap().to_owned();
    let path = prelude.strip_prefix("file://").unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    let line = there[0]["range"]["start"]["line"].as_u64().unwrap() as usize;
    assert!(text.lines().nth(line).unwrap().starts_with("field sphere(") && std::fs::metadata(path).unwrap().permissions().readonly());

    let found = client.ask("textDocument/references", json!({ "textDocument": { "uri": client.uri("main.sdf") }, "position": Client::at(MAIN, "column(size"), "context": { "includeDeclaration": true } }));
    assert_eq!(found.as_array().unwrap().len(), 2);
    assert_eq!(client.ask("textDocument/documentHighlight", here(&client, "size)")).as_array().unwrap().len(), 3);

    let mut rename = here(&client, "column(size");
    rename["newName"] = json!("pillar");
    let edits = client.ask("textDocument/rename", rename.clone());
    assert_eq!(edited(MAIN, &edits["changes"][client.uri("main.sdf")]), MAIN.replace("column(size", "pillar(size"));
    assert_eq!(edited(COLUMN, &edits["changes"][client.uri("parts/column.sdf")]), COLUMN.replace("field column", "field pillar"));
    rename["newName"] = json!("size");
    let (code, why) = client.refused("textDocument/rename", rename);
    assert!(code == -32803 && why.contains("declared already"), "{code} {why}");

    let symbols = client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": client.uri("main.sdf") } }));
    let names: Vec<&str> = symbols.as_array().unwrap().iter().map(|symbol| symbol["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["parts/column.sdf", "size", "gold", "scene"]);
    assert_eq!(symbols[2]["children"][0]["name"], "color");
    let found = client.ask("workspace/symbol", json!({ "query": "colu" }));
    assert_eq!(found[0]["name"], "column");

    let document = json!({ "textDocument": { "uri": client.uri("main.sdf") } });
    let colors = client.ask("textDocument/documentColor", document.clone());
    assert_eq!(colors.as_array().unwrap().len(), 1);
    let given = json!({ "textDocument": document["textDocument"], "color": { "red": 1.0, "green": 0.5, "blue": 0.0, "alpha": 1.0 }, "range": colors[0]["range"] });
    assert_eq!(client.ask("textDocument/colorPresentation", given)[0]["label"], "#ff8000");

    let tokens = client.ask("textDocument/semanticTokens/full", document.clone());
    let count = tokens["data"].as_array().unwrap().len();
    assert!(count > 150 && count % 5 == 0, "{count}");
    let mut hinted = document.clone();
    hinted["range"] = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    let hints = client.ask("textDocument/inlayHint", hinted);
    assert!(hints.as_array().unwrap().iter().any(|hint| hint["label"].as_str().unwrap().starts_with("×2.")), "{hints}");
    assert_eq!(client.ask("textDocument/foldingRange", document.clone()), json!([]));

    let ugly = "scene=sphere( 1 )|box(1)\n";
    client.open("ugly.sdf", 7, ugly);
    let options = json!({ "textDocument": { "uri": client.uri("ugly.sdf") }, "options": { "tabSize": 4, "insertSpaces": true } });
    assert_eq!(edited(ugly, &client.ask("textDocument/formatting", options)), "scene = sphere(1) | box(1)\n");
    assert_eq!(client.stop(), 0);
}

#[test]
fn problems_come_with_their_mending() {
    let mut client = start("problems");
    assert!(client.diagnostics("main.sdf", Some(1)).is_empty());
    let wrong = MAIN.replace("sphere(size)", "spere(size)");
    client.change("main.sdf", 2, json!([{ "text": wrong }]));
    let told = client.diagnostics("main.sdf", Some(2));
    assert_eq!(messages(&told), ["nothing is named `spere`"]);
    assert!(told[0]["message"].as_str().unwrap().contains("did you mean `sphere`?") && told[0]["code"] == "unknown-name");
    let asked = json!({ "textDocument": { "uri": client.uri("main.sdf") }, "range": told[0]["range"], "context": { "diagnostics": told } });
    let actions = client.ask("textDocument/codeAction", asked);
    assert_eq!((&actions[0]["title"], &actions[0]["isPreferred"]), (&json!("Write `sphere`"), &json!(true)));
    let uri = client.uri("main.sdf");
    assert_eq!(edited(&wrong, &actions[0]["edit"]["changes"][&uri]), MAIN);

    // What is wrong in a file that is imported is told of that file; open texts count before those on disk.
    client.change("main.sdf", 3, json!([{ "text": MAIN }]));
    assert!(client.diagnostics("main.sdf", Some(3)).is_empty());
    let broken = COLUMN.replace("length", "lenght");
    client.open("parts/column.sdf", 1, &broken);
    let told = client.diagnostics("parts/column.sdf", Some(1));
    assert_eq!(messages(&told), ["this file has no scene", "nothing is named `lenght`"]);
    assert_eq!(told[0]["severity"], 3);
    // A file of parts has the factors that it has in a scene.
    client.change("parts/column.sdf", 2, json!([{ "text": format!("{COLUMN}shape leg = column(0.4).twist(y, 1)\n") }]));
    client.change("main.sdf", 4, json!([{ "text": MAIN.replace("sphere(size)", "leg") }]));
    assert!(client.diagnostics("main.sdf", Some(4)).is_empty());
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 9, "character": 0 } });
    let hints = client.ask("textDocument/inlayHint", json!({ "textDocument": { "uri": client.uri("parts/column.sdf") }, "range": whole }));
    assert!(hints.as_array().unwrap().iter().any(|hint| hint["label"].as_str().unwrap().starts_with('×') && hint["position"]["line"] == 2), "{hints}");
    client.change("main.sdf", 5, json!([{ "text": MAIN }]));
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": client.uri("parts/column.sdf") } }));
    client.listen(Duration::from_millis(1500));
    let of = |client: &Client, name: &str| {
        let uri = client.uri(name);
        let told = client.told.iter().rev().find(|told| told["method"] == "textDocument/publishDiagnostics" && told["params"]["uri"] == uri).unwrap();
        told["params"]["diagnostics"].as_array().unwrap().len()
    };
    // The file on disk is right.
    assert_eq!((of(&client, "parts/column.sdf"), of(&client, "main.sdf")), (0, 0));
    assert_eq!(client.stop(), 0);
}

#[test]
fn what_is_odd_is_refused_and_ends_nothing() {
    let mut client = start("odd");
    assert_eq!(client.refused("textDocument/nonsense", json!({})).0, -32601);
    assert_eq!(client.refused("textDocument/hover", json!({ "textDocument": 3 })).0, -32602);
    assert_eq!(client.refused("textDocument/hover", json!({ "textDocument": { "uri": ":/%%" }, "position": { "line": 0, "character": 0 } })).0, -32602);
    assert_eq!(client.refused("textDocument/hover", json!({ "textDocument": { "uri": "file:///nowhere%2" }, "position": { "line": 0, "character": 0 } })).0, -32602);
    for uri in ["untitled:Untitled-1", "file:///nowhere%25", "https://example.com/a.sdf", "file:", "file://host"] {
        let asked = json!({ "textDocument": { "uri": uri }, "position": { "line": 0, "character": 0 } });
        assert_eq!(client.ask("textDocument/hover", asked), Value::Null, "{uri}");
        client.tell("textDocument/didOpen", json!({ "textDocument": { "uri": uri, "languageId": "sdf", "version": 1, "text": "scene = sphere(1)\n" } }));
        let asked = json!({ "textDocument": { "uri": uri }, "position": { "line": 0, "character": 9 } });
        assert!(client.ask("textDocument/hover", asked)["contents"]["value"].as_str().unwrap().contains("sphere"), "{uri}");
    }
    for position in [json!({ "line": 4_000_000_000_u32, "character": 4_000_000_000_u32 }), json!({ "line": 0, "character": 4_000_000_000_u32 })] {
        for method in ["completion", "hover", "signatureHelp", "definition", "documentHighlight"] {
            client.ask(&format!("textDocument/{method}"), client.place("main.sdf", position.clone()));
        }
        client.change("main.sdf", 2, json!([{ "range": { "start": position, "end": { "line": 0, "character": 0 } }, "text": "" }]));
        client.change("main.sdf", 3, json!([{ "text": MAIN }]));
    }
    // What nobody opened, and what is closed twice.
    client.change("nowhere.sdf", 1, json!([{ "text": "" }]));
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": client.uri("nowhere.sdf") } }));
    client.tell("textDocument/didChange", json!({}));
    // A request that is cancelled before it is answered. Which of the two comes first is not told.
    let id = client.begin("workspace/symbol", json!({ "query": "" }));
    client.tell("$/cancelRequest", json!({ "id": id }));
    let answer = client.end(id);
    assert!(answer.get("result").is_some() || answer["error"]["code"] == -32800, "{answer}");
    assert!(client.diagnostics("main.sdf", Some(3)).is_empty());
    assert_eq!(client.stop(), 0);
    assert_eq!(start("gone").vanish(), 1);
}

/// A thousand edits, as fast as they can be sent: what is answered is answered of the text at hand, what is told is told of the version whose words it has, and
/// the last word is that of the last version.
#[test]
fn a_storm_of_edits_ends_with_the_right_words() {
    const EDITS: i64 = 1000;
    let mut client = Client::start("storm", &[]);
    let text = |version: i64| format!("let name_{version} = {version}\nscene = sphere(1) | missing_{version}(1)\n");
    client.open("main.sdf", 1, &text(1));
    let (mut first, mut asked) = (0, Vec::new());
    let began = Instant::now();
    for version in 2..=EDITS {
        // The numbers of three places, one after another, as a person would type them.
        let old = (version - 1).to_string().len() as u64;
        let place = |line: u64, at: u64| json!({ "start": { "line": line, "character": at }, "end": { "line": line, "character": at + old } });
        let new = version.to_string();
        let value = "let name_".len() as u64 + old + " = ".len() as u64;
        let missing = "scene = sphere(1) | missing_".len() as u64;
        let changes = [(0, value), (0, "let name_".len() as u64), (1, missing)].map(|(line, at)| json!({ "range": place(line, at), "text": new }));
        client.change("main.sdf", version, json!(changes));
        if version % 10 == 0 {
            let document = json!({ "textDocument": { "uri": client.uri("main.sdf") } });
            asked.push((version, client.begin("textDocument/documentSymbol", document)));
        }
        if version == 100 {
            first = memory(client.pid());
        }
        if version % 50 == 0 {
            std::thread::sleep(Duration::from_millis(120));
        }
    }
    for (version, id) in asked {
        let answer = client.end(id);
        assert_eq!(answer["result"][0]["name"], format!("name_{version}"), "{answer}");
    }
    let last = client.diagnostics("main.sdf", Some(EDITS));
    let took = began.elapsed();
    assert_eq!(messages(&last), [format!("nothing is named `missing_{EDITS}`")]);
    client.change("main.sdf", EDITS + 1, json!([{ "text": "scene = sphere(1)\n" }]));
    assert!(client.diagnostics("main.sdf", Some(EDITS + 1)).is_empty());
    client.listen(Duration::from_millis(500));
    let mut before = 0;
    let mut count = 0;
    for told in client.told.iter().filter(|told| told["method"] == "textDocument/publishDiagnostics") {
        let version = told["params"]["version"].as_i64().unwrap();
        assert!(version > before, "{version} after {before}");
        before = version;
        count += 1;
        let said: Vec<Value> = told["params"]["diagnostics"].as_array().unwrap().clone();
        assert_eq!(messages(&said), [format!("nothing is named `missing_{version}`")]);
    }
    assert!(count >= 2, "{count}");
    let grown = memory(client.pid()).saturating_sub(first);
    println!("{EDITS} edits in {took:?}: {count} versions compiled on the way, {grown} KiB more memory");
    assert!(grown < 48 << 10, "{grown} KiB more");
    assert_eq!(client.stop(), 0);
}

/// Kibibytes of memory that a process holds; 0 where the system does not say.
fn memory(pid: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(0)
}

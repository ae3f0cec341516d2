//! Films of runs: they show the contents of the trajectory, and state what they leave out.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use stripmine_physics::io::extxyz::{ParticleFrame, XyzFrames};
use stripmine_physics::particles::ParticleKind;

fn stripmine(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// Runs a preset into the folder of its name.
fn run(folder: &Path, preset: &str, sets: &[&str]) {
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let arguments: Vec<&str> = ["run", preset, "--quiet"].into_iter().chain(sets).collect();
    let output = stripmine(folder, &arguments);
    assert!(output.status.success(), "{preset}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Page of a film, and the film's data in it.
fn film(folder: &Path, preset: &str, color: &str) -> (String, Value) {
    let output = stripmine(folder, &["plot", preset, "--film", "--color", color, "--overwrite"]);
    assert!(output.status.success(), "{preset}: {}", String::from_utf8_lossy(&output.stderr));
    let page = fs::read_to_string(folder.join(format!("{preset}.plots/film.html"))).unwrap();
    let (_, rest) = page.split_once("<script type=\"application/json\">").unwrap();
    let film = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    (page, film)
}

/// Numbers of a column, and their largest rounding error.
fn column(column: &Value) -> (Vec<f64>, f64) {
    let [low, high, bytes] = ["low", "high", "bytes"].map(|key| column[key].as_f64().unwrap());
    let codes = STANDARD.decode(column["codes"].as_str().unwrap()).unwrap();
    let highest = 256f64.powf(bytes) - 2.0;
    let number = |code: &[u8]| {
        let code = code.iter().rev().fold(0.0, |code, &byte| 256.0 * code + f64::from(byte));
        if code > highest { f64::NAN } else { low + code / highest * (high - low) }
    };
    let numbers = codes.chunks_exact(bytes as usize).map(number).collect();
    (numbers, 0.50001 * (high - low) / highest + 1e-12 * high.abs().max(low.abs()))
}

fn trajectory(folder: &Path, preset: &str) -> Vec<ParticleFrame> {
    let frames = XyzFrames::open(folder.join(format!("{preset}.run/trajectory.xyz"))).unwrap().in_space();
    frames.map(Result::unwrap).collect()
}

/// Checks that times, positions, speeds and walls of a film are those of the trajectory; at most a given share of the positions is outside the
/// picture.
fn is_as_written(folder: &Path, preset: &str, most_beyond: f64) {
    let (page, film) = film(folder, preset, "speed");
    assert!(!page.contains("src=") && !page.contains("http://") && !page.contains("https://"), "{preset}");
    assert!(page.contains("prefers-reduced-motion") && page.contains("prefers-color-scheme"), "{preset}");
    let frames = trajectory(folder, preset);
    let times: Vec<f64> = film["times"].as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect();
    assert_eq!(times, frames.iter().map(|frame| frame.time).collect::<Vec<_>>(), "{preset}");
    let [(xs, x_off), (ys, y_off), (speeds, speed_off)] = ["x", "y", "shades"].map(|key| column(&film[key]));
    let fastest = film["shade"]["ends"][1].as_f64().unwrap();
    let count = frames[0].particles.grain_count();
    assert_eq!(xs.len(), frames.len() * count, "{preset}");
    let mut beyond = 0;
    for (moment, frame) in frames.iter().enumerate() {
        for (place, particle) in frame.particles.grains().iter().enumerate() {
            let at = moment * count + place;
            if xs[at].is_nan() {
                beyond += 1;
                continue;
            }
            let [x, y, _] = particle.position;
            let what = format!("{preset}, frame {moment}, particle {place}");
            assert!((x - xs[at]).abs() <= x_off, "{what}: x {x} became {}", xs[at]);
            assert!((y - ys[at]).abs() <= y_off, "{what}: y {y} became {}", ys[at]);
            let speed = particle.velocity.iter().map(|v| v * v).sum::<f64>().sqrt().min(fastest);
            assert!((speed - speeds[at]).abs() <= speed_off, "{what}: speed {speed} became {}", speeds[at]);
        }
    }
    assert!(f64::from(beyond) <= most_beyond * xs.len() as f64, "{preset}: {beyond} of {}", xs.len());
    let walls = frames[0].particles.all().iter().filter(|it| it.kind == ParticleKind::Wall).count();
    assert_eq!(column(&film["fixed"]["radii"]).0.len(), walls, "{preset}");
    // Rounded to 16 bits of the shown range.
    let [[left, _], [right, _]]: [[f64; 2]; 2] = serde_json::from_value(film["window"].clone()).unwrap();
    assert!(x_off < 1e-5 * (right - left), "{preset}");
}

#[test]
fn films_agree_with_trajectories_for_every_method() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, "pipe-small", &["run.steps=200", "run.snapshot_every=50"]);
    run(folder, "hard-disks", &["run.time=2", "run.snapshot_every=0.25"]);
    run(folder, "langevin-dense", &["run.steps=200", "run.snapshot_every=50"]);
    run(folder, "plummer", &["run.time=0.5", "run.snapshot_every=8"]);
    for (preset, most_beyond) in
        [("pipe-small", 0.0), ("hard-disks", 0.0), ("langevin-dense", 0.0), ("plummer", 0.1)]
    {
        is_as_written(folder, preset, most_beyond);
    }
    // A box has sides, bodies in space have none; the film states how both are seen.
    let (page, shown) = film(folder, "hard-disks", "psi6");
    assert_eq!(shown["sides"].as_array().unwrap().len(), 4);
    assert!(page.contains("periodic sides") && shown["shade"]["ends"] == serde_json::json!([0.0, 1.0]));
    // The crystal of the start is ordered, and melts.
    assert!(column(&shown["shades"]).0.iter().all(|order| (-1e-9..=1.0 + 1e-9).contains(order)));
    let orders = column(&shown["shades"]).0;
    let discs = orders.len() / shown["times"].as_array().unwrap().len();
    let mean = |orders: &[f64]| orders.iter().sum::<f64>() / orders.len() as f64;
    let [first, last] = [&orders[..discs], &orders[orders.len() - discs..]].map(mean);
    assert!(first > 0.9 && last < 0.8, "{first} {last}");
    let (page, shown) = film(folder, "plummer", "id");
    assert!(shown["sides"].as_array().unwrap().is_empty() && page.contains("Seen along z"));
    // An unavailable colour is refused, with the available ones.
    for (preset, color) in
        [("plummer", "psi6"), ("hard-disks", "spin"), ("hard-disks", "colour"), ("plummer", "force")]
    {
        let refused = stripmine(folder, &["plot", preset, "--film", "--color", color]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{preset} {color}: {said}");
        let others =
            ["speed", "psi6", "force", "spin", "radius", "id"].into_iter().filter(|word| *word != color);
        assert!(said.contains(color) && others.into_iter().all(|word| said.contains(word)), "{said}");
    }
}

#[test]
fn films_report_missing_and_omitted_frames() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(
        folder,
        "two-discs",
        &["run.steps=40", "run.thermo_every=10", "run.snapshot_every=40", "output.trajectory=false"],
    );
    let refused = stripmine(folder, &["plot", "two-discs", "--film"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(3) && said.contains("output.trajectory=true"), "{said}");
    fs::remove_dir_all(folder.join("two-discs.run")).unwrap();
    run(folder, "two-discs", &["run.steps=40", "run.thermo_every=10", "run.snapshot_every=40"]);
    let file = folder.join("two-discs.run/trajectory.xyz");
    let text = fs::read_to_string(&file).unwrap();
    let first: String = text.lines().take(4).map(|line| format!("{line}\n")).collect();
    fs::write(&file, &first).unwrap();
    let (page, shown) = film(folder, "two-discs", "speed");
    assert!(
        page.contains("The trajectory has only one frame") && shown["times"].as_array().unwrap().len() == 1
    );
    // Frames and particles beyond the limits: every fourth frame, and every third particle.
    let moment = |at: usize| first.replacen("Time=0.0", &format!("Time={at}.0"), 1);
    fs::write(&file, (0..3100).map(moment).collect::<String>()).unwrap();
    let (page, shown) = film(folder, "two-discs", "speed");
    let times: Vec<f64> = serde_json::from_value(shown["times"].clone()).unwrap();
    assert!(page.contains("Shows one of every 4 frames, of 3100."));
    assert_eq!(times, (0..775).map(|frame| 4.0 * f64::from(frame)).collect::<Vec<_>>());
    let row = first.lines().nth(2).unwrap();
    let rows = (1..=45_000).map(|id| row.replacen(" 0.0 1 ", &format!(" 0.0 {id} "), 1) + "\n");
    let comment = first.lines().nth(1).unwrap();
    fs::write(&file, format!("45000\n{comment}\n{}", rows.collect::<String>())).unwrap();
    let (page, shown) = film(folder, "two-discs", "id");
    assert!(page.contains("Shows one of every 3 particles."));
    let ids = column(&shown["shades"]).0;
    assert!(ids.len() == 15_000 && ids[0] == 1.0 && ids[14_999] == 44_998.0);
    fs::write(&file, "").unwrap();
    let refused = stripmine(folder, &["plot", "two-discs", "--film"]);
    assert_eq!(refused.status.code(), Some(3));
}

//! Plots of runs and starts, without another program.

use std::fs;
use std::process::{Command, Output, Stdio};

fn stripmine(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// The terminal shows a line for each quantity that changes; an unknown column is refused with the known ones.
#[test]
fn plots_appear_in_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("two-discs");
    let (run, plots) = (run.to_str().unwrap(), folder.path().join("pictures"));
    let short = ["--set", "run.steps=4000", "--set", "run.thermo_every=100", "--out", run];
    assert!(stripmine(&[&["run", "two-discs", "--quiet"][..], &short].concat()).status.success());
    let drawn = stripmine(&["plot", run, "--out", plots.to_str().unwrap()]);
    let text = String::from_utf8_lossy(&drawn.stdout).into_owned();
    assert!(text.contains("kinetic") && text.contains('█') && text.contains('▁'), "{text}");
    for file in fs::read_dir(&plots).unwrap().map(|file| file.unwrap().path()) {
        let is_svg = file.extension().is_some_and(|kind| kind == "svg");
        let svg = if is_svg { fs::read_to_string(&file).unwrap() } else { continue };
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{}", file.display());
    }
    let some = stripmine(&["plot", run, "--columns", "kinetic,elastik", "--out", "/dev/null/x"]);
    let said = String::from_utf8_lossy(&some.stderr).into_owned();
    assert!(some.status.code() == Some(2) && said.contains("elastik") && said.contains("elastic"), "{said}");
    assert_eq!(stripmine(&["plot", folder.path().join("none").to_str().unwrap()]).status.code(), Some(5));
}

/// The page has every picture that is written beside it, the film, the numbers and the scene, and loads nothing.
#[test]
fn a_page_holds_all_pictures_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let [run, plots] = ["run", "plots"].map(|name| folder.path().join(name));
    let (run, out) = (run.to_str().unwrap(), plots.to_str().unwrap());
    let sets =
        ["--set", "run.steps=4000", "--set", "run.thermo_every=100", "--set", "run.snapshot_every=1000"];
    let begun = stripmine(&[&["run", "two-discs", "--quiet", "--out", run][..], &sets].concat());
    assert!(begun.status.success());
    assert!(stripmine(&["plot", run, "--out", out]).status.success());
    let page = fs::read_to_string(plots.join("index.html")).unwrap();
    let files = fs::read_dir(&plots).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let pictures: Vec<String> =
        files.filter_map(|name| Some(name.strip_suffix(".svg")?.to_owned())).collect();
    assert!(pictures.len() > 3, "{pictures:?}");
    for name in &pictures {
        assert!(page.contains(&format!("<svg id=\"{name}-picture\"")), "{name}");
        assert!(page.contains(&format!("href=\"#{name}\"")), "{name}");
    }
    assert_eq!(page.matches("<svg id=").count(), pictures.len());
    // 5 frames: at the start and after every 1000 of 4000 steps.
    let times = page.split_once("\"times\":[").unwrap().1.split_once(']').unwrap().0;
    assert_eq!(times.split(',').count(), 5, "{times}");
    for expected in ["<td class=\"words\">kinetic</td>", "[particles]", "default-src 'none'", "@media print"]
    {
        assert!(page.contains(expected), "{expected}");
    }
    let inner = page.replace("url(#", "");
    for loading in ["src=", "@import", "url(", "http://", "https://", "fetch("] {
        assert!(!inner.contains(loading), "{loading}");
    }
    // Without a trajectory the page says so.
    fs::remove_file(format!("{run}/trajectory.xyz")).unwrap();
    assert!(stripmine(&["plot", run, "--out", out, "--quiet"]).status.success());
    let page = fs::read_to_string(plots.join("index.html")).unwrap();
    assert!(page.contains("No film: ") && !page.contains("class=\"film\""), "{page}");
}

/// Files of a run may have been edited: any contents give pictures or an exit code, never a panic.
#[test]
fn edited_runs_are_drawn_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("two-discs");
    let short = ["--set", "run.steps=40", "--set", "run.thermo_every=10", "--set", "run.snapshot_every=20"];
    let begun =
        stripmine(&[&["run", "two-discs", "--quiet", "--out", run.to_str().unwrap()][..], &short].concat());
    assert!(begun.status.success());
    let [table, frames] =
        ["thermo.csv", "trajectory.xyz"].map(|name| fs::read_to_string(run.join(name)).unwrap());
    let radius = frames.lines().nth(2).unwrap().split(' ').nth(8).unwrap().to_owned();
    let second = table.lines().nth(2).unwrap().to_owned();
    let number = second.split(',').nth(2).unwrap();
    let table_with = |value: &str| table.replace(&second, &second.replacen(number, value, 1));
    let frames_with = |value: &str| frames.replace(&format!(" {radius} "), &format!(" {value} "));
    let cases = [
        ("radius 1e300", table.clone(), frames_with("1e300"), 0),
        ("radius 1e-300", table.clone(), frames_with("1e-300"), 0),
        ("radius 1e9", table.clone(), frames_with("1e9"), 0),
        (
            "places 1e300",
            table.clone(),
            frames.replace("Si ", "Si 1e300 ").replace(":1:velo", ":1:x:R:1:velo"),
            0,
        ),
        (
            "a box of 1e300",
            table.clone(),
            frames.replacen("Lattice=\"", "Lattice=\"1e300 0 0 0 1e-300 0 0 0 1\" was=\"", 9),
            0,
        ),
        ("no frames", table.clone(), String::new(), 0),
        ("no number", table_with("nan"), frames.clone(), 3),
        ("infinite", table_with("inf"), frames.clone(), 3),
        ("enormous", table_with("1.7e308"), frames.clone(), 0),
        ("both ways enormous", table_with("-1.7e308").replacen(number, "1.7e308", 1), frames.clone(), 0),
        ("a word", table_with("x"), frames.clone(), 3),
        ("a heading only", table.lines().next().unwrap().to_owned() + "\n", frames.clone(), 3),
        ("nothing", String::new(), frames.clone(), 3),
        ("columns out of the folder", table.replacen("kinetic", "../../kinetic", 1), frames.clone(), 0),
        ("columns of one name", table.replacen("kinetic", "elastic", 1), frames.clone(), 0),
    ];
    for (what, table, frames, code) in cases {
        fs::write(run.join("thermo.csv"), table).unwrap();
        fs::write(run.join("trajectory.xyz"), frames).unwrap();
        let out = folder.path().join(what);
        let drawn = stripmine(&["plot", run.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&drawn.stderr).into_owned();
        assert_eq!(drawn.status.code(), Some(code), "{what}: {said}");
        assert!(!said.contains("panicked"), "{what}: {said}");
    }
    assert!(
        fs::read_dir(folder.path()).unwrap().all(|it| !it
            .unwrap()
            .file_name()
            .to_str()
            .unwrap()
            .contains("kinetic"))
    );
}

/// Frames of a trajectory with another value of a property, for the first particle or for all.
fn frames_with(frames: &str, property: &str, value: &str, all: bool) -> String {
    let (mut place, mut is_done) = (0..0, false);
    let mut with_it = |line: &str| {
        let mut words: Vec<&str> = line.split_whitespace().collect();
        if let Some((_, properties)) = line.split_once("Properties=") {
            let properties: Vec<&str> = properties.split_whitespace().next().unwrap().split(':').collect();
            let mut first = 0;
            for of in properties.chunks(3) {
                let count: usize = of[2].trim_matches('"').parse().unwrap();
                if of[0].trim_matches('"') == property {
                    place = first..first + count;
                }
                first += count;
            }
            is_done = false;
        } else if words.len() > 1 && (all || !is_done) {
            words[place.clone()].fill(value);
            is_done = true;
            return words.join(" ") + "\n";
        }
        line.to_owned() + "\n"
    };
    frames.lines().map(&mut with_it).collect()
}

/// Extreme but finite numbers of particles, with every colour: pictures, or an exit code, never a panic.
#[test]
fn extreme_particles_are_drawn_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("gas");
    let short = ["particles.count=100", "run.steps=20", "run.thermo_every=10", "run.snapshot_every=10"]
        .map(|it| ["--set", it]);
    let begun =
        [&["run", "dense-gas", "--quiet", "--out", run.to_str().unwrap()][..], &short.concat()].concat();
    assert!(stripmine(&begun).status.success());
    let frames = fs::read_to_string(run.join("trajectory.xyz")).unwrap();
    let out = folder.path().join("pictures");
    for property in ["pos", "velo", "radius", "mass", "omega"] {
        for (value, all) in [("1e300", false), ("1e300", true), ("1.7e308", true), ("5e-324", true)] {
            fs::write(run.join("trajectory.xyz"), frames_with(&frames, property, value, all)).unwrap();
            for (color, more) in
                [("psi6", "--film"), ("force", "--quiet"), ("speed", "--film"), ("spin", "--quiet")]
            {
                let what = format!("{property} {value} (all: {all}) by {color}");
                let arguments =
                    ["plot", run.to_str().unwrap(), "--color", color, more, "--out", out.to_str().unwrap()];
                let drawn = stripmine(&arguments);
                let said = String::from_utf8_lossy(&drawn.stderr).into_owned();
                assert!(matches!(drawn.status.code(), Some(0 | 2 | 3)), "{what}: {:?} {said}", drawn.status);
                assert!(!said.contains("panicked"), "{what}: {said}");
            }
        }
    }
}

/// A run's folder is found by the name of its scene.
#[test]
fn runs_are_found_by_scene_name() {
    let folder = tempfile::tempdir().unwrap();
    let stripmine = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        command.args(arguments).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap()
    };
    let short = ["--set", "run.steps=20", "--set", "run.thermo_every=5"];
    assert!(stripmine(&[&["run", "two-discs", "--quiet"][..], &short].concat()).status.success());
    assert!(stripmine(&["plot", "two-discs"]).status.success());
    assert!(folder.path().join("two-discs.plots/last-state.png").exists());
}

/// Numbers of a path or of an attribute.
fn numbers(text: &str) -> Vec<f64> {
    let mut all: Vec<String> = vec![];
    let mut inside = false;
    for letter in text.chars() {
        let goes_on = letter.is_ascii_digit() || letter == '.';
        if letter == '-' || goes_on && !inside {
            all.push(String::new());
        }
        inside = letter == '-' || goes_on;
        if let Some(number) = all.last_mut().filter(|_| inside) {
            number.push(letter);
        }
    }
    all.iter().map(|number| number.parse().unwrap()).collect()
}

fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    text.split_once(from).unwrap_or_else(|| panic!("no {from}")).1.split_once(to).unwrap().0
}

/// The start of a scene is drawn with its sides, plane walls and discs at their places; options of runs are refused.
#[test]
fn starts_are_drawn_with_their_walls() {
    let folder = tempfile::tempdir().unwrap();
    let stripmine = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stripmine"));
        let output =
            command.args(arguments).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap();
        let [said, failed] =
            [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it).into_owned());
        (output.status.code(), said, failed)
    };
    // A box of 12 × 8 with discs at (3, 4) and (6, 4.25).
    let scene = stripmine(&["scene", "show", "two-discs"]).1;
    let walls = "[[walls]]\nfrom = [1.0, 1.0]\nto = [11.0, 2.0]\nvelocity = [0.0, 0.5]\n";
    fs::write(folder.path().join("boxed.toml"), scene + walls).unwrap();
    let (code, said, failed) = stripmine(&["plot", "boxed.toml"]);
    assert_eq!(code, Some(0), "{failed}");
    assert_eq!(said, "start: boxed.plots/start.svg\nstart: boxed.plots/start.png\n");
    let svg = fs::read_to_string(folder.path().join("boxed.plots/start.svg")).unwrap();
    let paths = || svg.split(" d=\"").skip(1).map(|path| path.split('"').next().unwrap());
    let lines: Vec<Vec<f64>> = paths()
        .filter(|path| !path.contains('h') && path.matches('L').count() == 1)
        .map(numbers)
        .filter(|numbers| numbers.len() == 4)
        .collect();
    let [left, right, bottom, top, wall, ..] = &lines[..] else { panic!("{lines:?}") };
    let [width, height] = [right[0] - left[0], top[1] - bottom[1]];
    let place = |x: f64, y: f64| [left[0] + width * x / 12.0, bottom[1] + height * y / 8.0];
    let ends = [place(1.0, 1.0), place(11.0, 2.0)].concat();
    assert!(wall.iter().zip(&ends).all(|(found, end)| (found - end).abs() < 0.2), "{wall:?} {ends:?}");
    // Dots are in tenths of a pixel.
    let dots: Vec<Vec<f64>> = paths().filter(|path| path.contains("h1")).map(numbers).collect();
    for centre in [place(3.0, 4.0), place(6.0, 4.25)] {
        let is_there =
            |dot: &Vec<f64>| dot.iter().zip(centre).all(|(found, at)| (found / 10.0 - at).abs() < 0.2);
        assert!(dots.iter().any(is_there), "{centre:?} {dots:?}");
    }

    let (code, said, failed) = stripmine(&["plot", "plummer", "--set", "particles.count=50", "--json"]);
    assert_eq!(code, Some(0), "{failed}");
    let side: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(side["files"].as_array().unwrap().len(), 4, "from above and from the side: {said}");
    assert!(folder.path().join("plummer.plots/start-side.png").is_file());
    for (arguments, code, words) in [
        (&["plot", "two-discs", "--film"][..], 2, "--film needs a run, and two-discs is a scene"),
        (&["plot", "boxed.toml", "--columns", "kinetic"], 2, "--columns needs a run"),
        (&["plot", "two-discs", "--set", "particles.radius=-1"], 3, "particles.radius"),
        (&["plot", "plummer", "--color", "psi6"], 2, "no hexatic order"),
        (&["run", "two-discs", "--set", "run.steps=20", "--quiet"], 0, ""),
        (
            &["plot", "two-discs", "--set", "particles.radius=0.4"],
            2,
            "--set needs a scene, and two-discs.run is a run",
        ),
    ] {
        let (found, _, failed) = stripmine(arguments);
        assert!(found == Some(code) && failed.contains(words), "{arguments:?}: {found:?} {failed}");
    }
}

/// The ribbon of a mean is drawn at the mean and error bar of `summary.json` and begins at the end of the transient, which is shaded in the
/// picture.
#[test]
fn charts_show_mean_and_transient_of_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("dense");
    let (run, plots) = (run.to_str().unwrap(), folder.path().join("pictures"));
    let hot = ["--set", "particles.temperature=20.0"];
    assert!(
        stripmine(&[&["run", "langevin-dense", "--quiet", "--out", run], &hot[..]].concat()).status.success()
    );
    let plotted = stripmine(&["plot", run, "--columns", "potential,msd", "--out", plots.to_str().unwrap()]);
    assert!(plotted.status.success(), "{}", String::from_utf8_lossy(&plotted.stderr));
    let summary = fs::read_to_string(folder.path().join("dense/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let quantities = summary["averages"]["quantities"].as_array().unwrap();
    let known = quantities.iter().find(|it| it["quantity"] == "potential").unwrap();
    let [mean, bar, cut] = ["mean", "bar", "equilibrated_at"].map(|key| known[key].as_f64().unwrap());
    assert!(cut > 0.0, "the run must have a transient");

    let svg = fs::read_to_string(plots.join("potential.svg")).unwrap();
    // Scale, both ends in pixels, both in values.
    let axis = |name: &str| {
        let all = between(&svg, &format!("{name}=\"lin"), "\"").to_owned();
        let ends: Vec<f64> = all.split(' ').filter_map(|it| it.parse().ok()).take(4).collect();
        move |pixel: f64| ends[2] + (pixel - ends[0]) / (ends[1] - ends[0]) * (ends[3] - ends[2])
    };
    let (x, y) = (axis("data-x"), axis("data-y"));
    let steps = numbers(between(&svg, "fill-opacity=\"0.25\" d=\"M", "z"));
    let [left, low, across, _, _, up, ..] = steps[..] else { panic!("{steps:?}") };
    let pixel = (y(0.0) - y(1.0)).abs();
    let near = |found: f64, expected: f64, off: f64| {
        assert!((found - expected).abs() <= off, "{found} instead of {expected}");
    };
    near(y(low), mean - bar, 0.02 * pixel);
    near(y(low + up), mean + bar, 0.03 * pixel);
    let second = x(1.0) - x(0.0);
    near(x(left), cut, 0.02 * second);
    near(x(left + across), 50.0, 0.03 * second);
    let shaded = between(&svg, "<title>transient, excluded from the mean</title>", "/>");
    let [from, _, width, ..] = numbers(shaded.split_once("x=").unwrap().1)[..] else { panic!("{shaded}") };
    near(x(from), 0.0, 0.1 * second);
    near(x(from + width), cut, 0.2 * second);
    // A quantity without a mean states the reason.
    let svg = fs::read_to_string(plots.join("msd.svg")).unwrap();
    assert!(!svg.contains("fill-opacity") && svg.contains("still changing"), "{svg}");
}

/// Bodies in any unit of length give the same number of dots at the same positions of the picture, and radii in the trajectory that other programs
/// can draw.
#[test]
fn pictures_of_bodies_do_not_depend_on_units() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = |name: &str, unit: f64| {
        // Four bodies revolve on a cross: speeds and masses keep their periods the same in every unit.
        let [x, y, v] = [1.0, 1.5, 0.3].map(|number| number * unit);
        let mass = unit.powi(3);
        let bodies = format!(
            "[[{mass:e}, {x:e}, 0.0, 0.0, 0.0, {v:e}, 0.0], [{mass:e}, {0:e}, 0.0, 0.0, 0.0, {2:e}, 0.0], \
             [{mass:e}, 0.0, {y:e}, 0.0, {2:e}, 0.0, 0.0], [{mass:e}, 0.0, {1:e}, 0.0, {v:e}, 0.0, 0.0]]",
            -x, -y, -v
        );
        let scene = format!(
            "format = 2\nunits = \"reduced\"\n[method]\nkind = \"nbody\"\n[particles]\ngenerate = \"list\"\nbodies = {bodies}\n\
             [integrator]\ndt = 0.01\n[run]\nsteps = 20\nsnapshot_every = 20\n"
        );
        let path = folder.path().join(format!("{name}.toml"));
        fs::write(&path, scene).unwrap();
        let [path, run, plots] =
            [path, folder.path().join(name), folder.path().join(format!("{name}.plots"))]
                .map(|path| path.to_str().unwrap().to_owned());
        for arguments in [&["run", &path, "--quiet", "--out", &run][..], &["plot", &run, "--out", &plots]] {
            let output = stripmine(arguments);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
        let frames = fs::read_to_string(folder.path().join(name).join("trajectory.xyz")).unwrap();
        let radius: f64 = frames.lines().nth(2).unwrap().split(' ').nth(8).unwrap().parse().unwrap();
        (
            fs::read_to_string(folder.path().join(format!("{name}.plots/last-state.svg"))).unwrap(),
            radius / unit,
        )
    };
    // Dots are paths: a width, and after each move a line of length 1.
    let dots = |svg: &str| -> Vec<[f64; 3]> {
        let paths = svg.split("<path stroke=").skip(1).map(|path| path.split("/>").next().unwrap());
        let mut dots = vec![];
        for path in paths.filter(|path| path.contains("h1")) {
            let numbers = numbers(path.split_once("stroke-width=").unwrap().1);
            let mut at = [0.0, 0.0];
            for moved in numbers[1..].chunks(3) {
                at = [at[0] + moved[0], at[1] + moved[1]];
                dots.push([numbers[0], at[0], at[1]]);
                at[0] += moved[2];
            }
        }
        dots
    };
    let (one, radius) = drawn("one", 1.0);
    let expected = dots(&one);
    // Four bodies with outlines, and their traces: at the start and at the end.
    assert_eq!(expected.len(), 2 * 4 + 2 * 4, "{expected:?}");
    for (name, unit) in [("nanometres", 1e-9), ("au", 1.496e11)] {
        let (svg, of_a_body) = drawn(name, unit);
        assert!((of_a_body / radius - 1.0).abs() < 1e-9, "{of_a_body} {radius}");
        let found = dots(&svg);
        assert_eq!(found.len(), expected.len(), "{name}");
        let is_near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 3.0);
        let all_are_in = |these: &[[f64; 3]], those: &[[f64; 3]]| {
            these.iter().all(|dot| those.iter().any(|other| is_near(dot, other)))
        };
        let is_same = all_are_in(&found, &expected) && all_are_in(&expected, &found);
        assert!(is_same, "{name}: {found:?} {expected:?}");
    }
}

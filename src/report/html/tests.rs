//! Tests of the whole page.

use super::*;
use crate::provenance::{MachineDescription, Provenance};
use crate::report::figure::{
    self, Chart, ChartAxis, Drawing, DrawnShape, Picture, Series, SeriesPoint, Style,
};
use crate::report::section::{Film, FilmFrame};
use crate::report::{FormattedTable, TableCell};
use stripmine_physics::origin::Origin;

const HOSTILE: &str = "<script>alert(\"&\")</script>";

fn section(name: &str) -> Section {
    let axis = |label: &str| ChartAxis::linear(label, Some(HOSTILE));
    let series = Series {
        name: HOSTILE.to_owned(),
        style: Style::Joined,
        hue: 0,
        points: vec![SeriesPoint::at(1.0, 2.0), SeriesPoint::at(2.0, 3.0)],
    };
    let figure = |name: &str, picture| Figure {
        name: name.to_owned(),
        title: HOSTILE.to_owned(),
        caption: HOSTILE.to_owned(),
        picture,
    };
    let chart = Chart { x: axis(HOSTILE), y: axis(HOSTILE), series: vec![series], bands: vec![] };
    let drawing = Drawing {
        window: [[0.0; 2], [1.0; 2]],
        width: 100.0,
        shapes: vec![DrawnShape::Line { ends: [[0.0; 2], [1.0; 2]] }],
        shades: None,
        guide: None,
    };
    Section {
        name: name.to_owned(),
        title: format!("{name} {HOSTILE}"),
        chapter: Chapter::Sources,
        question: HOSTILE.to_owned(),
        expected: HOSTILE.to_owned(),
        answer: format!("`{HOSTILE}` {HOSTILE}"),
        details: vec![HOSTILE.to_owned()],
        figures: vec![
            figure("chart", Picture::Charts(vec![(String::new(), chart)])),
            figure("drawing", Picture::Drawing(drawing)),
        ],
        tables: vec![FormattedTable {
            name: "table".to_owned(),
            title: HOSTILE.to_owned(),
            columns: vec![HOSTILE.to_owned(), "count".to_owned()],
            rows: vec![vec![HOSTILE.into(), TableCell::Count(1_234_567)]],
            notes: vec![HOSTILE.to_owned()],
        }],
        excerpt: Some((HOSTILE.to_owned(), HOSTILE.to_owned())),
        film: Some(Film {
            title: HOSTILE.to_owned(),
            units: [HOSTILE.to_owned(), HOSTILE.to_owned()],
            window: [[0.0; 2], [1.0; 2]],
            sides: vec![],
            falls: false,
            radii: vec![0.1],
            fixed: vec![],
            frames: vec![FilmFrame { time: 0.0, walls: vec![], discs: vec![([0.5, 0.5], 1.0)] }],
            shade: HOSTILE.to_owned(),
            shades: [0.0, 1.0],
        }),
        claims: vec![],
        seeds: vec![1993, 7],
        front: Some(1),
        depends_on_host: true,
        provenance: Some(Provenance {
            origin: Origin {
                version: "1.2.3".into(),
                commit: "0123abc".into(),
                dirty: true,
                target: "some-target".into(),
            },
            command: "some command".into(),
            machine: MachineDescription {
                processor: HOSTILE.into(),
                model: Some(HOSTILE.into()),
                cores: 2,
                clock: None,
                caches: vec![HOSTILE.into()],
                governor: Some(HOSTILE.into()),
                is_virtual: None,
                compiler: HOSTILE.into(),
            },
            threads: 2,
            instruction_set: "scalar".into(),
            seconds: 1.5,
            date: "2026-11-24".into(),
            processes: 3,
            code: None,
            repeated: vec![],
        }),
    }
}

fn page() -> String {
    let drawn = |_: &Section, figure: &Figure| figure::svg(figure).unwrap();
    render(&[section("first"), section("second")], &["old".to_owned()], &Tally::default(), &drawn)
}

#[test]
fn data_cannot_inject_elements() {
    let page = page();
    assert!(!page.contains("<script>alert"), "a text was not escaped");
    assert!(page.contains("&lt;script&gt;alert(&quot;&amp;&quot;)&lt;/script&gt;"));
    // The number of script elements, opened and closed, is that of our own scripts and data.
    let data = 1 + 2;
    assert_eq!(page.matches("<script").count(), SCRIPTS.len() + data);
    assert_eq!(page.matches("</script").count(), SCRIPTS.len() + data);
}

#[test]
fn scripts_and_styles_cannot_end_their_elements() {
    assert!(SCRIPTS.iter().all(|script| !script.contains("</script") && !script.contains("<!--")));
    assert!(!STYLE.contains("</style"));
}

#[test]
fn the_page_loads_nothing() {
    // Except definitions inside the page.
    let page = page().replace("url(#", "");
    for attribute in
        ["src=", "srcset=", "action=", "poster=", "@import", "url(", "fetch(", "XMLHttpRequest", "import("]
    {
        assert!(!page.contains(attribute), "{attribute}");
    }
    for link in page.split("href=\"").skip(1) {
        let target = &link[..link.find('"').unwrap()];
        assert!(!target.contains("//"), "{target}");
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn every_item_is_linked() {
    let page = page();
    for name in ["first", "second"] {
        // Contents, first screen, summary and heading.
        assert_eq!(page.matches(&format!("href=\"#{name}\"")).count(), 4, "{name}");
        assert!(page.contains(&format!("<section id=\"{name}\"")));
    }
}

#[test]
fn an_item_shows_seeds_data_and_origin() {
    let page = page();
    assert!(page.contains("<td>1\u{202f}234\u{202f}567</td>"));
    assert!(page.contains("Seeds: 1993, 7."));
    assert!(page.contains("href=\"host/first/\""));
    assert!(page.contains(
        "Made on 2026-11-24 in 1.5 s with 2 threads in 3 processes by <code>some command</code>, source commit 0123abc with changes."
    ));
    // Once in the head, with the machine.
    assert_eq!(
        page.matches("2 items made on 2026-11-24 by stripmine 1.2.3 of source commit 0123abc").count(),
        1
    );
    assert!(page.contains("in no commit"));
}

#[test]
fn paired_backquotes_mark_code() {
    assert_eq!(prose("a `b<c` d").into_string(), "a <code>b&lt;c</code> d");
    assert_eq!(prose("a ` d").into_string(), "a ` d");
}

#[test]
fn inline_pictures_share_markers() {
    let page = page();
    assert_eq!(page.matches("<svg id=").count(), 4);
    // Colours for dark screens follow a picture where it is shown a second time.
    assert_eq!(page.matches("class=\"drawn").count(), 4);
    // The first screen repeats one picture per item.
    assert_eq!(page.matches("<use href=\"#").count(), 2);
    assert_eq!(page.matches("<marker id=\"m0-0072b2\"").count(), 1);
    assert_eq!(page.matches("marker:url(#m0-0072b2)").count(), 2);
    // A browser would show it as a tooltip everywhere; the titles of series are read by the script.
    assert!(!page.contains("<desc>"));
    assert_eq!(page.matches("<title>").count(), 1 + 2);
}

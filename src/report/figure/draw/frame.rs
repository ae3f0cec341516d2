//! A picture with axes: its size, and what the library is asked for.

use super::super::{Scale, style};
use super::axis::Span;
use super::words::Title;
use kuva::prelude::{Layout, Plot, Theme};
use kuva::render::color::Color;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{Primitive, Scene, render_multiple};

/// Room for the words at one number of an axis (pixels): across, and up.
const NUMBER: [f64; 2] = [80.0, 34.0];

/// What the library leaves too little between the numbers of the vertical axis and its heading (pixels).
const TO_HEADING: f64 = 5.0;

/// A picture with axes.
pub struct Frame<'a> {
    /// The words above it.
    pub title: &'a str,
    /// The horizontal axis.
    pub x: &'a Span,
    /// The vertical axis.
    pub y: &'a Span,
    /// The width that something at the right of the axes needs; none for the library's colour bar.
    pub right: Option<f64>,
    /// The least height between the axes' ends.
    pub height: f64,
}

impl Frame<'_> {
    /// Draws plots over the axes. `more` changes what the library is asked for.
    pub fn draw(&self, plots: Vec<Plot>, more: impl FnOnce(Layout) -> Layout) -> Drawn {
        let title = Title::new(self.title, style::WIDTH, 1.0);
        let height = self.height.max(style::PLOT_HEIGHT);
        let asked = more(self.asked(&plots, height)).with_width(style::WIDTH).with_height(height + 130.0);
        // The library reckons the room that numbers and headings need.
        let needed = ComputedLayout::from_layout(&asked);
        let (left, bottom) = (needed.margin_left + TO_HEADING, needed.margin_bottom);
        let right = self.right.unwrap_or(needed.margin_right);
        let across = (style::WIDTH - left - right).max(style::PLOT_WIDTH);
        let asked = asked
            .with_width((left + across + right).max(title.width()))
            .with_height(title.bottom() + height + bottom)
            .with_force_margins(left, (left + across + right).max(title.width()) - left - across)
            .with_force_margins_y(title.bottom(), bottom);
        let places = ComputedLayout::from_layout(&asked);
        let mut scene = render_multiple(plots, asked);
        // Names of windows, which have none in our files.
        scene.defs.clear();
        title.primitives().for_each(|words| scene.add(words));
        Drawn { scene, places }
    }

    fn asked(&self, plots: &[Plot], height: f64) -> Layout {
        let Frame { x, y, .. } = self;
        let most = |length: f64, room: f64| (length / room).floor();
        let of_plots = || Layout::auto_from_plots(plots);
        let ends = |axis: &Span| (axis.ends[0], axis.ends[1]);
        let mut asked = if self.right.is_some() { Layout::new(ends(x), ends(y)) } else { of_plots() };
        asked = asked
            .with_theme(theme())
            .with_font_family(style::FONTS)
            .with_title_size(style::TITLE as u32)
            .with_label_size(style::HEADING as u32)
            .with_tick_size(style::LABEL as u32)
            .with_body_size(style::LABEL as u32)
            .with_axis_line_width(style::AXIS)
            .with_box_axes()
            .with_x_label(x.heading.clone())
            .with_y_label(y.heading.clone())
            .with_x_label_wrap(letters(style::PLOT_WIDTH))
            .with_y_label_wrap(letters(height))
            .with_y_label_offset(-TO_HEADING, 0.0)
            .with_x_tick_format(x.format(most(style::PLOT_WIDTH, NUMBER[0])))
            .with_y_tick_format(y.format(most(height, NUMBER[1])))
            .with_x_axis_min(x.ends[0])
            .with_x_axis_max(x.ends[1])
            .with_y_axis_min(y.ends[0])
            .with_y_axis_max(y.ends[1]);
        asked.show_legend = false;
        if x.scale == Scale::Logarithmic {
            asked = asked.with_log_x();
        }
        if y.scale == Scale::Logarithmic {
            asked = asked.with_log_y();
        }
        // Between decades, each of which is marked, there are eight numbers.
        if [x, y].iter().all(|axis| axis.is_logarithmic() && axis.decades() > 4.0) {
            asked = asked.with_minor_ticks(9);
        }
        asked
    }
}

/// A picture, and where numbers lie on it.
pub struct Drawn {
    /// The picture.
    pub scene: Scene,
    /// Where numbers lie on it.
    pub places: ComputedLayout,
}

impl Drawn {
    /// Puts things on the plane between the axes' ends, and says where numbers lie on it. `more` are further attributes.
    pub fn fill(&mut self, x: &Span, y: &Span, more: &str, things: Vec<Primitive>) {
        let places = &self.places;
        let [left, right] = [places.margin_left, places.width - places.margin_right];
        let [top, bottom] = [places.margin_top, places.height - places.margin_bottom];
        let axes = format!(
            "fill=\"none\" data-x=\"{}\" data-y=\"{}\"",
            x.scale_between(left, right),
            y.scale_between(bottom, top)
        );
        let plane = Primitive::GroupStart { transform: None, title: None, extra_attrs: Some(axes + more) };
        let inside = |it: &Primitive| matches!(it, Primitive::ClipStart { .. });
        let at = self.scene.elements.iter().position(inside).map_or(0, |at| at + 1);
        let all = std::iter::once(plane).chain(things).chain([Primitive::GroupEnd]);
        self.scene.elements.splice(at..at, all);
    }
}

/// How many letters of a heading find room in a length.
fn letters(length: f64) -> usize {
    (length / (0.5 * style::HEADING)) as usize
}

/// The library's colours, in ours.
pub fn theme() -> Theme {
    let [paper, ink, grid] = [style::PAPER, style::INK, style::GRID].map(|colour| colour.to_string());
    Theme {
        background: paper,
        axis_color: ink.clone(),
        tick_color: ink.clone(),
        text_color: ink.clone(),
        colorbar_border: ink,
        grid_color: grid,
        ..Theme::light()
    }
}

/// A colour, for the library.
pub fn colour(colour: style::Colour) -> Color {
    Color::Rgb(colour.0, colour.1, colour.2)
}

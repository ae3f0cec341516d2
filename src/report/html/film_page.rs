//! Separate page for a film.

use super::{PAGE, PLAYER, STRIPS, compact_script, film, head};
use crate::report::section::Film;
use maud::{DOCTYPE, PreEscaped, html};

/// Renders the page of a film with notes below it. The film plays at once, unless the reader prefers reduced motion or the address ends in
/// `#frame=N`, which shows that frame.
pub(crate) fn film_page(shown: &Film, notes: &[String]) -> String {
    let title = html! { title { (shown.title) } }.into_string();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head { (head(&PreEscaped(title))) }
            body.alone {
                main {
                    h1 { (shown.title) }
                    (film::film_element(shown, &html! {}))
                    @for note in notes {
                        p.note { (note) }
                    }
                    p.note { "Space: play or pause. Arrow keys: next or previous frame. Home and End: first and last frame." }
                }
                (film::json_element("shades", &film::shades()))
                @for script in [PAGE, STRIPS, PLAYER] {
                    script { (PreEscaped(compact_script(script))) }
                }
            }
        }
    };
    page.into_string()
}

//! A film as a page of its own.

use super::{PAGE, PLAYER, STRIPS, compact, film, head};
use crate::report::section::Film;
use maud::{DOCTYPE, PreEscaped, html};

/// The page of a film, with lines below it that a reader must know. It plays at once, unless the reader wants no motion or the address
/// ends in `#frame=N`, which shows that frame.
pub(crate) fn film_page(shown: &Film, notes: &[String]) -> String {
    let title = html! { title { (shown.title) } }.into_string();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head { (head(&PreEscaped(&title))) }
            body.alone {
                main {
                    h1 { (shown.title) }
                    (film::holder(shown, &html! {}))
                    @for note in notes {
                        p.note { (note) }
                    }
                    p.note { "Space plays and stops, arrow keys go a frame on and back, Home and End to the ends." }
                }
                (film::embedded("shades", &film::shades()))
                @for script in [PAGE, STRIPS, PLAYER] {
                    script { (PreEscaped(compact(script))) }
                }
            }
        }
    };
    page.into_string()
}

//! The page of a reproduction: what the sources say, what came out, how to get it again.

use super::origin::Origin;

/// One item of the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// What it is.
    pub title: String,
    /// What the source says.
    pub says: String,
    /// What came out.
    pub came_out: String,
    /// The command that makes it again.
    pub again: String,
    /// Tables and pictures, in Markdown.
    pub body: String,
    /// Where the data lie, relative to the page.
    pub files: String,
}

/// The page in Markdown.
pub fn render(sections: &[Section], origin: &Origin) -> String {
    let mut page = String::from("# What came out\n\nWritten by `stripmine reproduce`; do not edit.\n");
    for Section { title, says, came_out, again, body, files } in sections {
        page.push_str(&format!(
            "\n## {title}\n\n*The source says:* {says}\n\n*What came out:* {came_out}\n\n*To get it again:* `{again}`. \
             *Data:* [{files}]({files})\n\n{body}"
        ));
    }
    let Origin { version, commit, dirty, target } = origin;
    let state = if *dirty { " with changes that are in no commit" } else { "" };
    page.push_str(&format!(
        "\n---\n\nMade by stripmine {version}, source commit {commit}{state}, built for {target}. Nothing on this page \
         depends on the host.\n"
    ));
    page
}

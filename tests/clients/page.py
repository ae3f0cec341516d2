"""Opens the page of a reproduction in a browser without a window and uses it as a reader would.

    python page.py PAGE.html [PICTURES_FOLDER]

Needs the package `playwright`, and Chromium: playwright's own, or one that is installed (CHROMIUM names another).
Where one of them cannot be had, the check says SKIPPED and why, and exits with 0.

Every chart and map must draw, answer the pointer and zoom; every legend must hide its series; every film must play,
by the button and by the keyboard. Exits with 1 if one does not, if the page asks the network for anything, complains
on the console, or is wider than the screen. With a folder, pictures of the page as wide, narrow, both in the dark, printed
and without scripts are left there.
"""

import os
import shutil
import sys
from pathlib import Path

WIDTHS = {"wide": 1400, "narrow": 420}
# Coloured dots of a canvas: an empty picture has none, and measured marks may cover each other all but one.
FEWEST_DOTS = 50
# The whole page is a picture of some 50 000 lines (milliseconds).
SCREENSHOT = 120_000
# Marks and fillings have colours; axes, grid and texts are grey, and grounds behind the marks are pale.
COLOURED = """canvas => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let dots = 0;
    for (let i = 0; i < data.length; i += 4) {
        const [r, g, b, a] = data.slice(i, i + 4);
        if (a > 128 && Math.max(r, g, b) - Math.min(r, g, b) > 40) dots++;
    }
    return dots;
}"""


class Wrong(Exception):
    """Something a reader would complain about."""


def demand(held, complaint):
    if not held:
        raise Wrong(complaint)


def browser_of(playwright):
    """A browser, or the reason why there is none."""
    reasons = []
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    installed = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    for path in (None, installed) if installed else (None,):
        try:
            return playwright.chromium.launch(executable_path=path, args=["--no-sandbox"]), None
        except Exception as error:  # playwright has no narrower class for a browser that is not there
            reasons.append(str(error).strip().splitlines()[0])
    return None, "; ".join(reasons)


def open_page(browser, address, width, complaints, **options):
    """The page in a window of a width; what it should not do is added to the complaints."""
    page = browser.new_context(viewport={"width": width, "height": 800}, **options).new_page()
    page.on("console", lambda said: said.type == "error" and complaints.append(f"console: {said.text}"))
    page.on("pageerror", lambda error: complaints.append(f"script: {error}"))

    def requested(request):
        # Files beside the page stand for pictures on paper and without scripts.
        beside = request.url.startswith(address.rsplit("/", 1)[0]) and request.url.endswith(".svg")
        if request.url != address and not beside and not request.url.startswith(("data:", "blob:")):
            complaints.append(f"asks for {request.url}")

    page.on("request", requested)
    page.goto(address)
    return page


def name_of(picture):
    return picture.evaluate("picture => picture.closest('figure').id")


def dots_of(picture):
    return picture.query_selector("canvas:not(.legend canvas)").evaluate(COLOURED)


def read_out(page, picture):
    """What the pointer reads somewhere on a plane."""
    box = picture.query_selector(".u-over").bounding_box()
    # Coarsely first; a chart of few points needs a closer look.
    for down, right in [(i / n, j / n) for n in (12, 24) for i in range(1, n) for j in range(1, n)]:
        page.mouse.move(box["x"] + right * box["width"], box["y"] + down * box["height"])
        shown = picture.query_selector(".read-out:not([hidden])")
        # A band's line has no axis; a point's or a cell's read-out has one.
        if shown and len(shown.query_selector_all("div")) >= 2:
            return shown.inner_text().splitlines()
    return []


def check_plane(page, picture):
    """A chart or a map: pointer, zoom by dragging, all of it again."""
    over = picture.query_selector(".u-over")
    over.scroll_into_view_if_needed()
    lines = read_out(page, picture)
    demand(len(lines) >= 3, "the pointer reads nothing")
    before = picture.query_selector("canvas").evaluate("canvas => canvas.toDataURL()")
    changed = lambda: picture.query_selector("canvas").evaluate("canvas => canvas.toDataURL()") != before
    box = over.bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.2 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"], steps=4)
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.7 * box["height"], steps=4)
    page.mouse.up()
    page.wait_for_timeout(100)
    demand(changed(), "dragging does not zoom")
    page.mouse.dblclick(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_timeout(100)
    demand(not changed(), "a double click does not show all again")
    return " | ".join(lines)


def check_legend(page, picture):
    """Hiding every series leaves no colour on the chart; showing them again brings all of it back."""
    before = dots_of(picture)
    buttons = picture.query_selector_all(".legend button")
    demand(buttons, "no legend")
    page.mouse.move(0, 0)
    for expected in ("false", "true"):
        for button in buttons:
            button.click()
            demand(button.get_attribute("aria-pressed") == expected, "a legend's button does not say its state")
        page.wait_for_timeout(100)
        dots = dots_of(picture)
        demand(dots == (before if expected == "true" else 0), f"legend pressed {expected}: {dots} of {before} dots")


def check_film(page, picture):
    player = picture.query_selector(".player")
    frame = lambda: int(player.get_attribute("data-frame"))
    last = int(picture.query_selector("input[type=range]").get_attribute("max"))
    if last < 1:
        return "a single frame"
    start = frame()
    button = picture.query_selector("button.play")
    button.click()
    page.wait_for_timeout(900)
    button.click()
    demand(frame() > start, "the film does not play")
    played = frame()
    page.wait_for_timeout(400)
    demand(frame() == played, "the film does not stop")
    player.focus()
    for key, expected in (("Home", 0), ("ArrowRight", 1), ("ArrowLeft", 0), ("End", last)):
        page.keyboard.press(key)
        demand(frame() == expected, f"{key} goes to frame {frame()} instead of {expected}")
    page.keyboard.press("Space")
    page.wait_for_timeout(900)
    page.keyboard.press("Space")
    demand(0 < frame() < last, "the film does not play from its beginning by the space bar")
    return f"{last + 1} frames, {played - start} of them played"


def check_pictures(page):
    """A line for every picture, and how many of them failed."""
    failures = 0
    for picture in page.query_selector_all(".picture"):
        kind = picture.get_attribute("data-kind")
        words = []
        try:
            if kind == "film":
                words.append(check_film(page, picture))
            else:
                words.append(check_plane(page, picture))
            # A film of grains that do not spin yet begins in grey.
            dots = dots_of(picture)
            demand(dots >= FEWEST_DOTS, f"drew {dots} coloured dots")
            if kind == "chart":
                check_legend(page, picture)
        except Wrong as complaint:
            failures += 1
            words.append(f"FAILED: {complaint}")
        except AttributeError:
            failures += 1
            words.append("FAILED: did not draw")
        print(f"  {kind} {name_of(picture)}: {'; '.join(words)}", flush=True)
    return failures


def widest(page):
    """How much of the page lies beyond the right edge of the screen (pixels)."""
    return page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")


def unread(page):
    """How many charts and maps do not show their files, where they stand for what a script draws."""
    missing = 0
    for picture in page.query_selector_all(".picture:not([data-kind=film])"):
        picture.scroll_into_view_if_needed()
        file = picture.query_selector("img.on-paper")
        for _ in range(50):
            shown = file and file.evaluate("it => it.complete && it.naturalWidth > 0 && it.height > 0")
            if shown:
                break
            page.wait_for_timeout(100)
        missing += not shown
    return missing


def keep(page, folder, name):
    if folder:
        page.screenshot(path=folder / f"{name}.png", full_page=True, timeout=SCREENSHOT)


def check(browser, path, folder):
    address = path.resolve().as_uri()
    complaints = []
    failures = 0
    for name, width in WIDTHS.items():
        page = open_page(browser, address, width, complaints)
        page.wait_for_timeout(300)
        keep(page, folder, name)
        astray = page.evaluate("""() => [...document.querySelectorAll('a[href^="#"]')]
            .map(link => link.getAttribute('href').slice(1)).filter(id => !document.getElementById(id))""")
        complaints.extend(f"a link leads nowhere: #{name}" for name in astray)
        beyond = widest(page)
        if beyond > 0:
            complaints.append(f"{name}: {beyond} pixels wider than the screen")
        print(f"{name} ({width} pixels):")
        failures += check_pictures(page)
        dark = open_page(browser, address, width, complaints, color_scheme="dark")
        dark.wait_for_timeout(300)
        keep(dark, folder, f"{name}-dark")
    page = open_page(browser, address, WIDTHS["wide"], complaints)
    if folder:
        page.pdf(path=folder / "printed.pdf", format="A4", prefer_css_page_size=True)
    page.emulate_media(media="print")
    if lacking := unread(page):
        complaints.append(f"{lacking} pictures are missing on paper")
    plain = open_page(browser, address, WIDTHS["wide"], complaints, java_script_enabled=False)
    keep(plain, folder, "without-scripts")
    if lacking := unread(plain):
        complaints.append(f"{lacking} pictures are missing without scripts")
    complaints = list(dict.fromkeys(complaints))
    for complaint in complaints:
        print(f"FAILED: {complaint}")
    return failures + len(complaints)


def main():
    if len(sys.argv) not in (2, 3) or not Path(sys.argv[1]).is_file():
        print("usage: page.py PAGE.html [PICTURES_FOLDER]", file=sys.stderr)
        sys.exit(2)
    folder = Path(sys.argv[2]) if len(sys.argv) == 3 else None
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        print("SKIPPED (no playwright: pip install playwright && playwright install chromium)")
        return
    with sync_playwright() as playwright:
        browser, reason = browser_of(playwright)
        if browser is None:
            print(f"SKIPPED (no Chromium: {reason})")
            return
        print(f"Chromium {browser.version}")
        failures = check(browser, Path(sys.argv[1]), folder)
        browser.close()
    print("OK" if failures == 0 else f"{failures} FAILED")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()

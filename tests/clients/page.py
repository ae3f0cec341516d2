"""Opens the page of a reproduction in a browser without a window and uses it as a reader would.

    python page.py PAGE.html [PICTURES_FOLDER]

Needs the package `playwright`, and Chromium: playwright's own, or an installed one (CHROMIUM gives its path).
If one of them is missing, the check prints SKIPPED with the reason and exits with 0.

Every picture must be visible and have colours, with folded parts opened, in both widths, in dark mode, on paper and without scripts. Every chart
and map must show values at the pointer and by the keyboard. Every film must play, by the button and by the keyboard. Exits with 1
if one does not, if the page requests anything from the network, logs an error to the console, or is wider than the screen. With a
folder, saves pictures of the page there: wide, narrow, both in dark mode, printed and without scripts.
"""

import os
import shutil
import sys
from pathlib import Path

WIDTHS = {"wide": 1400, "narrow": 420}
# Fewest coloured dots of a drawn canvas: an empty picture has none, and measured marks may cover each other almost completely.
FEWEST_DOTS = 50
# Time limit in milliseconds: the whole page is a picture of some 50 000 lines.
SCREENSHOT = 120_000
# Marks and fills have colours; axes, grid and labels are grey, and backgrounds behind the marks are pale.
COLOURED = """canvas => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let dots = 0;
    for (let i = 0; i < data.length; i += 4) {
        const [r, g, b, a] = data.slice(i, i + 4);
        if (a > 128 && Math.max(r, g, b) - Math.min(r, g, b) > 40) dots++;
    }
    return dots;
}"""
# Returns a reader's complaint about a picture, or nothing: it must be visible, its text must contrast with its background, the background must be
# that of the page, no text may be cut off, and every marker it refers to must be defined.
LACKING = """svg => {
    const [box, ink] = [svg.getBoundingClientRect(), getComputedStyle(svg).fill];
    if (box.width < 100 || box.height < 50 || !svg.checkVisibility()) return "is not visible";
    const reused = svg.querySelector(":scope > use");
    if (reused) return document.querySelector(".picture > svg" + reused.getAttribute("href")) ? "" : "shows a missing picture";
    const ground = getComputedStyle(svg.querySelector(":scope > rect")).fill;
    const light = colour => colour.match(/\\d+/g).slice(0, 3).map(Number).reduce((sum, part) => sum + part) / 765;
    if (Math.abs(light(ink) - light(ground)) < 0.7) return "has too little contrast";
    if (Math.abs(light(ground) - light(getComputedStyle(document.body).backgroundColor)) > 0.1) return "has another background than the page";
    for (const text of svg.querySelectorAll("text")) {
        const at = text.getBoundingClientRect();
        const beyond = Math.max(box.left - at.left, at.right - box.right, box.top - at.top, at.bottom - box.bottom);
        if (beyond > 1) return `cuts off "${text.textContent}" by ${beyond.toFixed(1)} pixels`;
    }
    for (const [, name] of svg.innerHTML.matchAll(/url\\(#([^)]+)\\)/g)) {
        if (!document.getElementById(name)) return `refers to a missing marker: ${name}`;
    }
}"""
# Points on curves, marks and cells, in pixels of the window.
MARKS = """svg => [...svg.querySelectorAll("[data-x] path")].flatMap(path => {
    const length = path.getTotalLength();
    const onScreen = part => path.getPointAtLength(part * length).matrixTransform(path.getScreenCTM());
    return [0, 0.5, 1].map(onScreen).map(({ x, y }) => [x, y]);
})"""


class Wrong(Exception):
    """Something a reader would complain about."""


def demand(held, complaint):
    if not held:
        raise Wrong(complaint)


def browser_of(playwright):
    """Returns a browser and None, or None and the reason."""
    reasons = []
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    installed = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    for path in (None, installed) if installed else (None,):
        try:
            return playwright.chromium.launch(executable_path=path, args=["--no-sandbox"]), None
        except Exception as error:  # playwright raises no narrower class for a missing browser
            reasons.append(str(error).strip().splitlines()[0])
    return None, "; ".join(reasons)


def open_page(browser, address, width, complaints, **options):
    """Opens the page in a window of a width; errors and requests to other addresses are added to the complaints."""
    page = browser.new_context(viewport={"width": width, "height": 800}, **options).new_page()
    page.on("console", lambda said: said.type == "error" and complaints.append(f"console: {said.text}"))
    page.on("pageerror", lambda error: complaints.append(f"script: {error}"))

    def requested(request):
        if request.url != address and not request.url.startswith(("data:", "blob:")):
            complaints.append(f"requests {request.url}")

    page.on("request", requested)
    page.goto(address)
    # Folded parts are checked too.
    page.evaluate("document.querySelectorAll('details').forEach(details => { details.open = true; })")
    return page


def name_of(picture):
    return picture.evaluate("picture => picture.closest('figure')?.id ?? picture.getAttribute('aria-label')")


def shown(page):
    """Lines of the visible tooltip, or an empty list."""
    tip = page.query_selector(".tip:not([hidden])")
    return tip.inner_text().splitlines() if tip else []


def check_tips(page, svg):
    """A chart or a map shows values at the pointer, none away from it, and values by the keyboard."""
    svg.scroll_into_view_if_needed()
    page.wait_for_timeout(50)
    lines = []
    window = page.viewport_size
    for x, y in svg.evaluate(MARKS):
        if 0 <= x < window["width"] and 0 <= y < window["height"]:
            page.mouse.move(x, y)
            lines = shown(page)
            # A band's tooltip has no values; a point's or a cell's has one for each axis.
            if len(lines) >= 3:
                break
    demand(len(lines) >= 3, "no tooltip at the pointer")
    demand(not any("NaN" in line or "undefined" in line for line in lines), f"the tooltip shows {lines}")
    beyond = page.evaluate("""() => { const at = document.querySelector(".tip").getBoundingClientRect();
        return at.left < 0 || at.right > innerWidth || at.top < 0 || at.bottom > innerHeight; }""")
    demand(not beyond, "the tooltip extends beyond the window")
    page.mouse.move(0, 0)
    demand(not shown(page), "the tooltip remains away from the data")
    svg.focus()
    page.keyboard.press("ArrowRight")
    demand(len(shown(page)) >= 3, "no tooltip by the keyboard")
    svg.evaluate("svg => svg.blur()")
    return " | ".join(lines)


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
    """Prints a line for every interactive picture and returns the number of failures."""
    failures = 0
    for kind, selector in (("chart", ".picture > svg[tabindex]:has([data-x])"), ("film", ".film")):
        for picture in page.query_selector_all(selector):
            try:
                if kind == "film":
                    words = check_film(page, picture)
                    dots = picture.query_selector("canvas").evaluate(COLOURED)
                    demand(dots >= FEWEST_DOTS, f"drew {dots} coloured dots")
                else:
                    words = check_tips(page, picture)
            except Wrong as complaint:
                failures += 1
                words = f"FAILED: {complaint}"
            except AttributeError:
                failures += 1
                words = "FAILED: did not draw"
            print(f"  {kind} {name_of(picture)}: {words}", flush=True)
    return failures


def widest(page):
    """Width of the page beyond the right edge of the screen (pixels)."""
    return page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")


def look(page, how, complaints, on_screen=True):
    """Checks that every picture is visible and readable and that nothing extends beyond the screen."""
    pictures = page.query_selector_all(".picture > svg")
    if not pictures:
        complaints.append(f"{how}: no pictures")
    for picture in pictures:
        if lacking := picture.evaluate(LACKING):
            complaints.append(f"{how}: {name_of(picture)} {lacking}")
    beyond = widest(page)
    if on_screen and beyond > 0:
        complaints.append(f"{how}: {beyond} pixels wider than the screen")


def keep(page, folder, name):
    if folder:
        page.screenshot(path=folder / f"{name}.png", full_page=True, timeout=SCREENSHOT)


def accessible(page, how, complaints):
    """Adds the violations found by axe, a checker of accessibility."""
    try:
        from axe_playwright_python.sync_playwright import Axe
    except ImportError:
        print("axe: SKIPPED (no axe-playwright-python)")
        return
    # axe is injected into the page, whose policy allows no scripts from elsewhere.
    found = Axe().run(page).response["violations"]
    for violation in found:
        places = ", ".join(str(node["target"][0]) for node in violation["nodes"][:3])
        complaints.append(f"{how}: axe: {violation['id']}: {violation['help']} ({len(violation['nodes'])}: {places})")
    print(f"axe, {how}: {len(found)} violations")


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
        look(page, name, complaints)
        accessible(page, name, complaints)
        print(f"{name} ({width} pixels):")
        failures += check_pictures(page)
        dark = open_page(browser, address, width, complaints, color_scheme="dark")
        dark.wait_for_timeout(300)
        keep(dark, folder, f"{name}-dark")
        look(dark, f"{name}, in dark mode", complaints)
        accessible(dark, f"{name}, in dark mode", complaints)
        plain = open_page(browser, address, width, complaints, java_script_enabled=False)
        keep(plain, folder, f"{name}-without-scripts")
        look(plain, f"{name}, without scripts", complaints)
    page = open_page(browser, address, WIDTHS["wide"], complaints)
    if folder:
        page.pdf(path=folder / "printed.pdf", format="A4", prefer_css_page_size=True)
    page.emulate_media(media="print")
    look(page, "on paper", complaints, on_screen=False)
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

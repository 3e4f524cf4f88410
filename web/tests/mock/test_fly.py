"""Commands: only what is meant is sent, and each result is shown."""

import time

import pytest

from visitor import SIZES


def result(page) -> str:
    return page.locator(".commands .result").inner_text()


def state(page) -> str:
    return page.locator(".readout dd").first.inner_text()


def wait_for_state(page, wanted: str) -> None:
    page.wait_for_function(
        "wanted => document.querySelector('.readout dd').textContent === wanted",
        arg=wanted,
        timeout=4000,
    )


def engage(page) -> None:
    page.locator(".slide").focus()
    page.keyboard.down("Enter")
    time.sleep(1.3)
    page.keyboard.up("Enter")
    wait_for_state(page, "engaged")


def test_a_tap_does_not_engage(visit, mock):
    page = visit().open("fly")
    page.locator(".slide").click()
    page.locator(".slide").focus()
    page.keyboard.press("Enter")
    time.sleep(1.3)
    assert state(page) == "standby"


def test_slide_engages(visit, mock):
    page = visit().open("fly")
    box = page.locator(".slide").bounding_box()
    page.mouse.move(box["x"] + 30, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.5, box["y"] + 20, steps=4)
    page.mouse.up()
    time.sleep(0.5)
    assert state(page) == "standby"
    page.mouse.move(box["x"] + 30, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 4, box["y"] + 20, steps=8)
    page.mouse.up()
    wait_for_state(page, "engaged")
    assert "carried out at tick" in result(page)


def test_keys_pause_return_land_disengage(visit, mock):
    page = visit().open("fly")
    engage(page)
    for name, mode in [("Pause", "loiter"), ("Resume", "plan"), ("Return", "return")]:
        page.get_by_role("button", name=name, exact=True).focus()
        page.keyboard.press("Enter")
        page.wait_for_function(
            "mode => document.querySelectorAll('.readout dd')[1].textContent.startsWith(mode)",
            arg=mode,
            timeout=4000,
        )
    page.get_by_role("button", name="Land", exact=True).click()
    page.wait_for_function(
        "() => document.querySelector('.commands .result').textContent.startsWith('land: carried out')",
        timeout=4000,
    )


def test_slide_disengages(visit, mock):
    page = visit().open("fly")
    engage(page)
    page.locator(".slide").focus()
    page.keyboard.down("Enter")
    time.sleep(1.3)
    page.keyboard.up("Enter")
    wait_for_state(page, "standby")


def test_inhibits_are_shown_with_what_to_do(visit, mock):
    page = visit().open("fly")
    mock.set(inhibits=1 << 8)
    panel = page.locator(".conditions")
    panel.locator("li").wait_for()
    assert "too slow" in panel.inner_text()
    assert "upload a plan that takes off from here" in panel.inner_text()
    assert page.locator(".slide").is_disabled()


@pytest.mark.parametrize("size", SIZES)
def test_conditions_that_begin_and_end_move_no_control(visit, mock, size):
    page = visit(size).open("fly")

    def controls():
        return page.locator("button:visible, input:visible, .set-points, .pfd").evaluate_all(
            "all => all.map(one => JSON.stringify(one.getBoundingClientRect()))"
        )

    def conditions(bits: int, count: int, **pose) -> list[str]:
        mock.set(inhibits=bits, pose=pose)
        page.wait_for_function(
            "n => document.querySelectorAll('.conditions li').length === n", arg=count
        )
        return page.locator(".conditions strong").all_inner_texts()

    before = controls()
    assert len(before) > 10
    assert page.locator(".conditions h2").inner_text().lower() == "engaging is not inhibited"
    assert conditions(0b10, 1) == ["heading is missing"]
    assert controls() == before
    # Five: the newest first, how many there are, and all of them within reach of the keyboard.
    assert conditions(0b11111, 5)[-1] == "heading is missing"
    assert page.locator(".conditions h2").inner_text().endswith(": 5")
    assert controls() == before
    page.locator(".conditions ul").focus()
    page.keyboard.press("End")
    page.wait_for_function("() => document.querySelector('.conditions ul').scrollTop > 0")
    conditions(0, 0)
    assert controls() == before
    # In flight, too.
    conditions(0, 0, state=1)
    page.wait_for_selector(".conditions h2:text-is('No condition in flight')")
    page.wait_for_selector(".buttons button:enabled")
    before = controls()
    for faults, count in [(1 << 8, 1), (0b11111, 5), (0, 0)]:
        conditions(0, count, state=1, faults=faults)
        assert controls() == before


def focused(page) -> str:
    return page.evaluate("document.activeElement.textContent")


def test_the_focus_stays_when_its_control_is_disabled(visit, mock):
    page = visit().open("fly")
    engage(page)
    assert focused(page).startswith("Slide to disengage")
    # Pause cannot be given again: its opposite can.
    page.get_by_role("button", name="Pause", exact=True).focus()
    page.keyboard.press("Enter")
    page.wait_for_selector("button:has-text('Pause'):disabled")
    assert focused(page) == "Resume"
    page.keyboard.press("Enter")
    page.wait_for_selector("button:has-text('Resume'):disabled")
    assert focused(page) == "Pause"
    # Disengaged, and inhibited: nothing can be given, and the slide says so.
    page.get_by_role("button", name="Land", exact=True).focus()
    mock.set(inhibits=1)
    mock.command("disengage")
    page.wait_for_selector("button:has-text('Land'):disabled")
    assert focused(page).startswith("Engaging is inhibited")
    page.keyboard.down("Enter")
    time.sleep(1.3)
    page.keyboard.up("Enter")
    assert result(page).startswith("resume")
    assert state(page) == "standby"


def test_a_go_to_gives_the_focus_back(visit, mock):
    page = visit().open("fly")
    engage(page)
    for end in ("Cancel", "Fly there"):
        page.get_by_role("button", name="Go to…").click()
        page.locator(".chart-map").focus()
        page.keyboard.press("Enter")
        # The key chooses the place, and sends nothing.
        page.get_by_label("Altitude of go-to").wait_for()
        page.wait_for_timeout(300)
        assert "go to" not in result(page)
        page.get_by_role("button", name=end).focus()
        page.keyboard.press("Enter")
        page.locator(".target").wait_for(state="hidden")
        assert focused(page) == "Go to…"


def test_go_to_by_a_tap(visit, mock):
    page = visit().open("fly")
    engage(page)
    page.get_by_role("button", name="Go to…").click()
    page.locator(".chart-map").click(position={"x": 400, "y": 500})
    page.get_by_label("Altitude of go-to").fill("333")
    page.get_by_role("button", name="Fly there").click()
    page.wait_for_function(
        "() => document.querySelectorAll('.readout dd')[1].textContent === 'go to'", timeout=4000
    )
    page.wait_for_function(
        "() => document.querySelector('.set-points tr:nth-child(3) .set').textContent === '333'",
        timeout=4000,
    )


def test_set_points_in_hold_mode(visit, mock):
    page = visit().open("fly")
    engage(page)
    assert "A set point ends mode" in page.get_by_label("Set points").inner_text()
    mock.command({"set": {"altitude_m": 400}})
    page.get_by_label("New airspeed").wait_for(state="visible")
    page.get_by_role("button", name="ft", exact=True).click()
    page.get_by_label("New airspeed").fill("100")
    page.get_by_label("New airspeed").press("Enter")
    page.wait_for_function(
        "() => document.querySelector('.set-points tr:nth-child(1) .set').textContent === '100.0'",
        timeout=4000,
    )
    # Beyond the aircraft's limits nothing is sent.
    page.get_by_label("New airspeed").fill("300")
    page.get_by_label("New airspeed").press("Enter")
    time.sleep(0.5)
    assert page.locator(".set-points tr:nth-child(1) .set").inner_text() == "100.0"


def test_viewer_cannot_command(visit, mock):
    page = visit(link=mock.link.split("#")[0]).open("fly")
    assert page.locator(".slide").is_disabled()
    assert "View only" in page.locator(".viewer").inner_text()


def test_who_has_landed_is_told_to_disengage(visit, mock):
    land = 8
    page = visit().open("fly")
    mock.set(pose={"state": 1, "desired_guidance_mode": land, "estimated_north_mps": 20})
    page.wait_for_selector(".slide-text:text-is('Slide to disengage')")
    mock.set(
        pose={
            "state": 1,
            "desired_guidance_mode": land,
            "estimated_north_mps": 0,
            "estimated_east_mps": 0,
        }
    )
    page.wait_for_selector(".slide-text:text-is('Landed: slide to disengage')")

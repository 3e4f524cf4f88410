"""Commands: only what is meant is sent, and each result is shown."""

import time


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
    panel.wait_for(state="visible")
    assert "too slow" in panel.inner_text()
    assert "upload a plan that takes off from here" in panel.inner_text()
    assert page.locator(".slide").is_disabled()


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

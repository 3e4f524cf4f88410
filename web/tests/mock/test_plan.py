"""Drafts: no edit is lost, and the draft and the vehicle's plan are never confused."""

import json
import random
import time
import urllib.request

import pytest

HOSTILE = "<img src=x onerror=document.title='owned'>"


def items(page) -> int:
    return page.locator(".items tbody tr:not(.problem)").count()


def settled(page) -> None:
    page.wait_for_function(
        "() => document.querySelector('.save-state').textContent.startsWith('Saved')", timeout=8000
    )


def tool(page, name: str) -> None:
    page.get_by_role("group", name="What a tap on the map adds").get_by_role(
        "button", name=name, exact=True
    ).click()


@pytest.fixture
def plan(visit, mock):
    page = visit().open("plan")
    page.wait_for_selector(".items")
    settled(page)
    return page


def test_tap_adds_drag_moves_table_edits(plan, mock):
    before = items(plan)
    tool(plan, "Waypoint")
    plan.locator(".chart-map").click(position={"x": 620, "y": 300})
    plan.wait_for_function(
        "n => document.querySelectorAll('.items tbody tr:not(.problem)').length === n",
        arg=before + 1,
    )
    settled(plan)
    tool(plan, "Select")
    plan.wait_for_timeout(400)
    box = plan.locator("[aria-label^='Item 3,']").bounding_box()
    old = plan.get_by_label("Latitude of item 3, degrees").input_value()
    plan.mouse.move(box["x"] + 12, box["y"] + 12)
    plan.mouse.down()
    plan.mouse.move(box["x"] + 60, box["y"] + 80, steps=6)
    plan.mouse.up()
    plan.wait_for_function(
        "old => document.querySelector('[data-key=item-2-latitude_deg]').value !== old", arg=old
    )
    altitude = plan.get_by_label("Altitude of item 3, m")
    altitude.fill("275")
    altitude.press("Enter")
    settled(plan)
    time.sleep(0.3)
    settled(plan)
    saved = mock.draft("circuit")["plan"]["items"]
    assert len(saved) == before + 1
    assert saved[2]["altitude"]["m"] == 275
    assert saved[2]["place"]["latitude_deg"] == pytest.approx(
        float(plan.get_by_label("Latitude of item 3, degrees").input_value()), abs=1e-6
    )


def test_keys_move_a_point(plan, mock):
    old = float(plan.get_by_label("Latitude of item 4, degrees").input_value())
    plan.locator("[aria-label^='Item 4']").focus()
    plan.keyboard.press("ArrowUp")
    plan.wait_for_timeout(300)
    plan.keyboard.press("ArrowUp")
    plan.wait_for_timeout(300)
    moved = float(plan.get_by_label("Latitude of item 4, degrees").input_value())
    # Two steps of 10 m north: 111,195 m are a degree of the sphere.
    assert moved - old == pytest.approx(20 / 111_195, abs=2e-6)


def test_undo_and_redo_of_every_edit(plan, mock):
    first = mock.draft("circuit")["plan"]
    for label, value in [
        ("Altitude of item 3, m", "260"),
        ("Longitude of item 4, degrees", "7.95"),
        ("Speed of item 2, m/s", "50"),
    ]:
        field = plan.get_by_label(label)
        field.fill(value)
        field.press("Tab")
        plan.wait_for_timeout(150)
    plan.get_by_role("button", name="Delete item 5").click()
    plan.wait_for_timeout(400)
    settled(plan)
    last = mock.draft("circuit")["plan"]
    assert len(last["items"]) == len(first["items"]) - 1
    for _ in range(4):
        plan.keyboard.press("Control+z")
    plan.wait_for_timeout(500)
    settled(plan)
    assert mock.draft("circuit")["plan"] == first
    for _ in range(4):
        plan.keyboard.press("Control+Shift+Z")
    plan.wait_for_timeout(500)
    settled(plan)
    assert mock.draft("circuit")["plan"] == last


def test_draft_survives_reload_and_restart(plan, mock):
    plan.get_by_label("Altitude of item 3, m").fill("291")
    plan.keyboard.press("Tab")
    settled(plan)
    plan.wait_for_timeout(300)
    settled(plan)
    mock.stop()
    # Without the station: kept in the browser, and sent when it is back.
    plan.get_by_label("Altitude of item 4, m").fill("292")
    plan.keyboard.press("Tab")
    plan.wait_for_function(
        "() => /Not saved/.test(document.querySelector('.save-state').textContent)", timeout=5000
    )
    mock.start()
    settled(plan)
    saved = mock.draft("circuit")["plan"]["items"]
    assert [saved[2]["altitude"]["m"], saved[3]["altitude"]["m"]] == [291, 292]
    plan.reload()
    plan.wait_for_selector(".items")
    assert plan.get_by_label("Altitude of item 4, m").input_value() == "292"


def test_reload_before_the_station_is_back(plan, visit, mock):
    mock.stop()
    plan.get_by_label("Altitude of item 3, m").fill("293")
    plan.keyboard.press("Tab")
    plan.wait_for_function(
        "() => /Not saved/.test(document.querySelector('.save-state').textContent)", timeout=5000
    )
    mock.start()
    plan.reload()
    plan.wait_for_selector(".items")
    settled(plan)
    plan.wait_for_timeout(500)
    assert mock.draft("circuit")["plan"]["items"][2]["altitude"]["m"] == 293


def test_two_pages_share_a_draft(visit, mock):
    visitor = visit()
    one = visitor.open("plan")
    one.wait_for_selector(".items")
    two = visitor.again()
    two.goto(f"{visitor.base}#/plan")
    two.wait_for_selector(".items")
    one.get_by_label("Altitude of item 3, m").fill("301")
    one.keyboard.press("Tab")
    two.wait_for_function(
        "() => document.querySelector('[data-key=item-2-altitude]').value === '301'", timeout=4000
    )
    two.get_by_label("Altitude of item 3, m").fill("302")
    two.keyboard.press("Tab")
    one.wait_for_function(
        "() => document.querySelector('[data-key=item-2-altitude]').value === '302'", timeout=4000
    )


def test_conflict_is_shown_and_resolved(visit, mock):
    one = visit().open("plan")
    one.wait_for_selector(".items")
    one.context.set_offline(True)
    one.get_by_label("Altitude of item 3, m").fill("311")
    one.keyboard.press("Tab")
    one.wait_for_function(
        "() => /Not saved/.test(document.querySelector('.save-state').textContent)", timeout=8000
    )
    two = visit().open("plan")
    two.wait_for_selector(".items")
    two.get_by_label("Altitude of item 3, m").fill("312")
    two.keyboard.press("Tab")
    settled(two)
    two.wait_for_timeout(400)
    one.context.set_offline(False)
    one.get_by_role("button", name="Keep mine").click(timeout=10_000)
    two.wait_for_function(
        "() => document.querySelector('[data-key=item-2-altitude]').value === '311'", timeout=5000
    )


def test_problems_are_at_their_item(plan, mock):
    plan.get_by_label("Altitude of item 4, m").fill("1600")
    plan.keyboard.press("Tab")
    problem = plan.locator("tr.problem.error")
    problem.wait_for()
    assert "choose at most 1500 m" in problem.inner_text()
    assert (
        problem.evaluate(
            "row => row.previousElementSibling.querySelector('.item-number').textContent"
        )
        == "4"
    )
    assert plan.get_by_role("button", name="Upload to vehicle").is_disabled()


def test_vehicle_and_draft_are_compared_and_uploaded(plan, mock):
    plan.wait_for_function(
        "() => document.querySelector('.differs').textContent === \"Draft is the vehicle's plan\"",
        timeout=4000,
    )
    plan.get_by_label("Altitude of item 4, m").fill("310")
    plan.keyboard.press("Tab")
    plan.wait_for_function(
        "() => document.querySelector('.differs').textContent === 'Draft differs from vehicle'",
        timeout=4000,
    )
    settled(plan)
    plan.wait_for_timeout(600)
    plan.get_by_role("button", name="Upload to vehicle").click()
    plan.wait_for_function(
        "() => /read back: the vehicle has plan/.test(document.querySelector('.vehicle .result').textContent)",
        timeout=4000,
    )
    plan.wait_for_function(
        "() => document.querySelector('.differs').textContent === \"Draft is the vehicle's plan\"",
        timeout=4000,
    )


def test_names_and_problems_are_text(plan, mock):
    """A hostile draft of another client: its texts stay texts."""
    draft = mock.draft("circuit")
    draft["plan"]["items"][2]["kind"] = "camera"
    draft["plan"]["items"][2].update({"command": HOSTILE, "frame": 0, "parameters": []})
    body = json.dumps({"based_on": draft["revision"], "plan": draft["plan"]}).encode()
    headers = {"authorization": "Bearer mock", "content-type": "application/json"}
    urllib.request.urlopen(
        urllib.request.Request(
            f"http://127.0.0.1:{mock.port}/api/drafts/circuit", body, headers, method="PUT"
        )
    )
    plan.wait_for_function("() => document.body.textContent.includes('onerror')", timeout=4000)
    assert plan.locator(".items img").count() == 0
    assert plan.title() != "owned"


def test_an_import_is_a_new_draft_and_the_open_one_keeps_its_edits(plan, mock, tmp_path):
    with plan.expect_download() as download:
        plan.get_by_role("button", name="Export .plan").click()
    path = tmp_path / "exported.plan"
    download.value.save_as(path)
    exported = json.loads(path.read_text())
    assert exported == mock.draft("circuit")["plan"]
    exported["items"] = exported["items"][:3]
    path.write_text(json.dumps(exported))
    # Meanwhile an edit of the open draft cannot be saved.
    plan.route("**/api/drafts/circuit", lambda route: route.abort())
    altitude = plan.get_by_label("Altitude of item 3, m")
    altitude.fill("293")
    altitude.press("Enter")
    plan.wait_for_function(
        "() => document.querySelector('.save-state').textContent.startsWith('Not saved')"
    )
    for name in ("exported", "exported-2"):
        plan.locator("input[type=file]").set_input_files(path)
        plan.wait_for_selector(f".result:has-text('imported as a new draft, {name};')")
        assert plan.get_by_label("Draft", exact=True).input_value() == name
        assert items(plan) == 3
        settled(plan)
        assert mock.draft(name)["plan"] == exported
    # The draft that was open has its edit, and saves it.
    plan.unroute("**/api/drafts/circuit")
    plan.get_by_label("Draft", exact=True).select_option("circuit")
    plan.wait_for_function(
        "() => document.querySelectorAll('.items tbody tr:not(.problem)').length === 9"
    )
    assert altitude.input_value() == "293"
    settled(plan)
    assert mock.draft("circuit")["plan"]["items"][2]["altitude"]["m"] == 293


@pytest.mark.parametrize("seed", [1, 2])
def test_random_edits_are_never_lost(visit, mock, seed):
    """Edits, undos, reloads, restarts of the station and a cut network, in a drawn order."""
    chance = random.Random(seed)
    visitor = visit()
    page = visitor.open("plan")
    page.wait_for_selector(".items")
    wanted, up = None, True
    for step in range(30):
        action = chance.choice(["edit", "edit", "edit", "reload", "restart", "cut"])
        if action == "edit" or not up:
            wanted = str(200 + step)
            page.get_by_label("Altitude of item 3, m").fill(wanted)
            page.keyboard.press("Tab")
            page.wait_for_timeout(chance.choice([20, 150]))
            if not up and chance.random() < 0.5:
                page.context.set_offline(False)
                up = True
        elif action == "reload":
            page.reload()
            page.wait_for_selector("[data-key=item-2-altitude]", timeout=10_000)
        elif action == "restart":
            mock.stop()
            mock.start()
        else:
            page.context.set_offline(True)
            up = False
        if wanted:
            page.wait_for_function(
                "wanted => document.querySelector('[data-key=item-2-altitude]')?.value === wanted",
                arg=wanted,
                timeout=8000,
            )
    page.context.set_offline(False)
    settled(page)
    page.wait_for_timeout(300)
    settled(page)
    assert page.locator(".conflict, .notice.bad:visible").count() == 0
    assert str(mock.draft("circuit")["plan"]["items"][2]["altitude"]["m"]) == wanted

"""The faulty network: the rate of each fault, and no other changes."""

from __future__ import annotations

import itertools

import pytest

from fcc_hil.faults import Faults, FaultyLink


def through(
    faults: Faults, count: int = 20_000, seed: int = 3
) -> tuple[list[int], FaultyLink[str]]:
    """Send numbered datagrams 1 ms apart; return the numbers in order of arrival."""
    link: FaultyLink[str] = FaultyLink(faults, seed)
    arrived = []
    for number in range(count):
        link.offer(number * 1e-3, "client", number.to_bytes(4, "little"))
        arrived += [int.from_bytes(d, "little") for _, d in link.due(number * 1e-3)]
    arrived += [int.from_bytes(d, "little") for _, d in link.due(count * 1e-3 + 60.0)]
    return arrived, link


def test_a_good_network_changes_nothing() -> None:
    arrived, link = through(Faults())
    assert arrived == list(range(20_000))
    assert link.counts.offered == 20_000


# 20,000 draws: three sigma of a 2 % count is 59, of a 1 % count 42.
def test_the_rate_of_losses() -> None:
    arrived, link = through(Faults(loss=0.02))
    assert 20_000 - len(arrived) == link.counts.lost == pytest.approx(400, abs=60)
    assert arrived == sorted(set(arrived))


def test_the_rate_of_duplicates() -> None:
    arrived, link = through(Faults(duplicate=0.01))
    assert len(arrived) - 20_000 == link.counts.duplicated == pytest.approx(200, abs=42)
    assert set(arrived) == set(range(20_000))


def test_a_reordered_datagram_is_overtaken_by_the_next_and_not_lost() -> None:
    arrived, link = through(Faults(reorder=0.01))
    assert sorted(arrived) == list(range(20_000))
    late = [b for a, b in itertools.pairwise(arrived) if b < a]
    assert len(late) == link.counts.reordered == pytest.approx(200, abs=42)
    assert all(arrived[number + 1] == number for number in late)


def test_a_held_datagram_is_sent_if_no_other_follows() -> None:
    link: FaultyLink[str] = FaultyLink(Faults(reorder=1.0), seed=1)
    link.offer(0.0, "client", b"only")
    assert link.due(0.1) == []
    assert link.due(1.0) == [("client", b"only")]


def test_delay_and_jitter() -> None:
    link: FaultyLink[str] = FaultyLink(Faults(delay_s=0.025, jitter_s=0.010), seed=1)
    for number in range(100):
        link.offer(float(number), "client", b"x")
        assert link.due(number + 0.0249) == []
        assert link.due(number + 0.0351) == [("client", b"x")]


def test_truncation_shortens() -> None:
    link: FaultyLink[str] = FaultyLink(Faults(truncate=1.0), seed=1)
    for _ in range(100):
        link.offer(0.0, "client", bytes(509))
    lengths = [len(datagram) for _, datagram in link.due(0.0)]
    assert max(lengths) < 509
    assert min(lengths) < 50


def test_a_seed_repeats() -> None:
    faults = Faults(loss=0.1, duplicate=0.1, reorder=0.1, jitter_s=0.01)
    assert through(faults, 500, seed=5)[0] == through(faults, 500, seed=5)[0]
    assert through(faults, 500, seed=5)[0] != through(faults, 500, seed=6)[0]


def test_impossible_faults_are_refused() -> None:
    with pytest.raises(ValueError, match=r"loss = 2\.0: give a fraction"):
        Faults(loss=2.0)
    with pytest.raises(ValueError, match="delay_s"):
        Faults(delay_s=-1.0)

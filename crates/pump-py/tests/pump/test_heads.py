import pytest

import pumpmodel as pm


def test_heads_are_those_of_the_catalogue_with_their_documents() -> None:
    heads = pm.heads()
    assert len(heads) >= 40
    assert len({head.name for head in heads}) == len(heads)
    assert all(head.source.document and head.source.table and head.source.address for head in heads)
    assert all((head.source.quoted_by is None) == (head.source.kind == "maker") for head in heads)
    assert all(head.ml_per_rev > 0 for head in heads)
    # The L/S 16 delivers 0.8 mL per revolution of a Masterflex head: the number on every box of it.
    (head,) = [head for head in heads if head.name == "masterflex-ls-16"]
    assert (head.maker, head.ml_per_rev) == ("Masterflex", 0.8)


def test_words_narrow_the_list_and_a_head_becomes_a_pump() -> None:
    (head,) = pm.heads("kamoer", "1.52")
    assert head.name == "kamoer-kpmp10-1-52mm"
    assert pm.heads("no such head") == ()
    pump = pm.Pump.from_ml_per_rev("acid", ml_per_rev=head.ml_per_rev, rollers=head.rollers or 3)
    assert pump.volume_per_revolution_ml == pytest.approx(head.ml_per_rev, rel=1e-12)
    assert pm.Head.from_dict(head.to_dict()) == head

from mjforage.view.page import style


def test_colours_do_not_depend_on_company() -> None:
    alone = style.policy_styles(["levy"])["levy"].colour
    assert style.policy_styles(["mine", "greedy", "levy"])["levy"].colour == alone
    assert style.policy_styles(["mine"])["mine"].colour == style.policy_colour("mine")


def test_order_is_fixed_and_unknown_names_come_last() -> None:
    assert style.ordered(["zebra", "levy", "ape", "greedy"]) == ("greedy", "levy", "zebra", "ape")


def test_agent_colours_tell_roles_apart() -> None:
    colours = style.agent_colours(["scout", "scout", "forager", "tender"])
    assert len(set(colours)) == 4
    assert set(colours[:2]) <= set(style.ROLE_SHADES["scout"])
    assert colours[3] not in {s for shades in style.ROLE_SHADES.values() for s in shades}

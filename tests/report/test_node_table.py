"""The part of the report that says how far each node is from Cycles."""

from rayleaf.report import node_table


def described(kind="ShaderNodeMath", use="supported", **more):
    line = {"node": kind, "label": "Math", "use": use, "told": [], "told_of": {}, "not_compared": {}, "elsewhere": ""}
    modes = {"operation": ["ADD", "SINE"], "use_clamp": [False, True]}
    return {**line, "modes": modes, "inputs": ["Value", "Value_001"], "outputs": ["Value"], **more}


def compared(difference, bound, operation="ADD", oracle="values", **more):
    line = {"oracle": oracle, "case": f"Math {operation}", "node": "ShaderNodeMath", "output": "Value", "median": 0.0}
    line |= {"modes": {"operation": operation, "use_clamp": False}, "inputs": ["Value"]}
    return {**line, "difference": difference, "bound": bound, **more}


def test_cases_of_one_node_become_one_row_with_the_largest_difference():
    lines = [described(), compared(1e-3, 1e-1), compared(9e-6, 1e-5, "SINE"), compared(0.0, 1e-5)]
    (node,) = node_table.nodes(lines)
    assert (node.label, node.count, node.failed) == ("Math", 3, 0)
    assert (node.difference, node.bound, node.case) == (1e-3, 1e-1, "values: Math ADD")
    assert abs(node.share - 0.9) < 1e-12
    assert node.modes == {"operation": ["ADD", "SINE"], "use_clamp": [False]}


def test_what_no_case_has_is_told():
    (node,) = node_table.nodes([described(told_of={"operation=SINE": ["a mode"]}), compared(0.0, 1e-5)])
    assert node.lacking == ["input Value_001", "use_clamp=True"]
    shown = node_table.section([described(), compared(0.0, 1e-5)], "1 passed")
    assert "not compared: input Value_001, operation=SINE, use_clamp=True" in shown and "2 of 3" in shown


def test_what_is_beyond_its_bound_is_counted():
    lines = [described(), compared(2e-5, 1e-5), compared(0.0, 1e-5)]
    assert node_table.nodes(lines)[0].failed == 1
    shown = node_table.section(lines, "1 failed")
    assert "1 nodes, 2 cases, 1 beyond their bound" in shown and "200%" in shown


def test_nodes_without_a_comparison_are_rows_that_say_what_becomes_of_them():
    lines = [
        described("ShaderNodeScript", "left out", told=["Script nodes are not supported"]),
        described("NodeFrame", "organises", elsewhere="has no sockets"),
        described("ShaderNodeMath"),
        compared(0.0, 1e-5, node="ShaderNodeLater"),
    ]
    shown = node_table.section(lines, "1 passed")
    assert "left out: Script nodes are not supported" in shown
    assert "organises a tree; has no sockets" in shown
    assert "supported, and not compared in this run" in shown
    assert ">Later<" in shown and shown.count("<tr") == 5

"""The way the tests themselves run Blender."""


def test_a_script_reports_its_values_and_sees_its_arguments(run_blender):
    run = run_blender("import sys; report(arguments=sys.argv[1:]); report(answer=42)", "one", 2)
    assert run.report == {"arguments": ["one", "2"], "answer": 42}


def test_an_exception_in_a_script_ends_blender_with_an_exit_code(run_blender):
    run = run_blender("raise RuntimeError('as meant')", check=False)
    assert run.code == 1
    assert "as meant" in run.log


def test_the_add_on_is_found_in_the_build_folder(run_blender, addons):
    run = run_blender("import rayleaf; report(file=rayleaf.__file__)")
    assert run.report["file"].startswith(str(addons))

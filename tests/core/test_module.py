"""The extension module as plain Python sees it."""


def test_the_module_imports_without_blender(core):
    assert core.__name__ == "rayleaf._core"


def test_an_input_error_is_a_value_error(core):
    assert issubclass(core.InputError, ValueError)

"""`mjforage compile`."""

from mjforage.cli.console import app, output
from mjforage.cli.flags import Policies, Words


@app.command(name="compile")
def compile_kernels(
    *scenarios: str,
    policy: Policies = (),
    world: Words = (),
) -> None:
    """Compile what runs, films, environments and training need, before they are first used.

    It takes two to three minutes on one core; the first run or reset would wait for a part of them.
    For images of containers, and before the workers of a cluster start. Without --policy the first
    scenario has all policies, the others greedy and belief. The results lie in the user's cache, or
    in the folder of the environment variable NUMBA_CACHE_DIR, and are for this type of processor.

    Parameters
    ----------
    scenarios
        Shipped scenarios or TOML files; default comb-port, comb-port-weather, comb-port-radio and
        channels.
    policy
        May be given several times.
    world
        May be given several times; default graph and physics.
    """
    from mjforage.api.compiling import compile_kernels
    from mjforage.base.kernel_cache import kernel_folder
    from mjforage.cli.progress import working

    with working("compile"):
        compile_kernels(scenarios, policy, world)
    folder = kernel_folder()
    count = len(list(folder.glob("*.nbc"))) if folder is not None else 0
    output.print(f"{folder}: {count} kernels", soft_wrap=True)

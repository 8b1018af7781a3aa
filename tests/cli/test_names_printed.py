"""Names of files that hold what a terminal obeys are printed without it, and on one line."""

from small_scenes import block, head, write_scene

BODY = block(0.12, 0.1) + (
    "[material.m]\nE = 2e11\nnu = 0.3\nthickness = 0.005\n"
    '[supports.left]\non = "left"\nfix = { x = 0, y = 0 }\n[loads.w]\non = "right"\nforce = [0, -500]\n'
    "[mesh]\nsize = 0.06\n"
)
NAME = "es\x1b[31mc\nape"


def test_names_of_what_is_written(tmp_path, command):
    scene = write_scene(tmp_path, head("solid") + BODY)
    runs = [
        command("check", scene, "--picture", f"{NAME}.png"),
        command("replay", scene, "--out", "out.vtkhdf"),
        command("report", "out.vtkhdf", "--out", NAME, "--frames", "1"),
        command("export", "out.vtkhdf", "--as", "csv", "--out", f"{NAME}.csv"),
    ]
    for run in (runs[0], *runs[2:]):
        assert run.returncode == 0, run.stderr
        wrote = [line for line in run.stdout.splitlines() if line.startswith("wrote ")]
        assert wrote and all("es[31mc ape" in line for line in wrote) and "\x1b" not in run.stdout

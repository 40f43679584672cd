"""Files that are elsewhere: the same outputs, the same second run, and no secrets in what is kept."""

from __future__ import annotations

import gc
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from http.server import HTTPServer, SimpleHTTPRequestHandler
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from places import slow
from program import Ran, cli

fsspec = pytest.importorskip("fsspec", reason="fsspec is not installed: pip install '.[test]'")

SPEC = "steps: [{do: orient-joints, aim: y, up: z}]"
Batch = Callable[..., Ran]
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


@pytest.fixture(autouse=True)
def tidy() -> Iterator[None]:
    """Sockets that the libraries close late are closed here, not in whichever test comes next."""
    yield
    gc.collect()


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    """A server that speaks S3, which takes a second to import."""
    pytest.importorskip("s3fs", reason="s3fs is not installed: pip install '.[farms]'")
    moto = pytest.importorskip("moto.server", reason="moto is not installed: pip install '.[farms]'")
    found = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    found.start()
    host, port = found.get_host_and_port()
    yield f"http://{host}:{port}"
    found.stop()


@pytest.fixture
def bucket(server: str, samples: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A bucket with characters."""
    for name, value in {
        "ENDPOINT_URL": server,
        "ACCESS_KEY_ID": "name",
        "SECRET_ACCESS_KEY": "x" * 20,
    }.items():
        monkeypatch.setenv(f"AWS_{name}", value)
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    store = fsspec.filesystem("s3", use_listings_cache=False, skip_instance_cache=True)
    if store.exists("studio"):
        store.rm("studio", recursive=True)
    store.mkdir("studio")
    for name, key in (
        ("biped.glb", "in/a.glb"),
        ("biped.glb", "in/deep er/b#1.glb"),
        ("biped.gltf", "in/sub/biped.gltf"),
        ("biped.bin", "in/sub/biped.bin"),
        ("biped.usdz", "in/d.usdz"),
    ):
        store.put_file(str(samples / name), f"studio/{key}")
    return store


@pytest.fixture
def batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Batch:
    monkeypatch.chdir(tmp_path)
    Path("rig.yaml").write_text(SPEC)

    def run(*words: str, inputs: tuple[str, ...] = ("s3://studio/in/**/*.gl*",)) -> Ran:
        given = [
            "batch",
            *inputs,
            "--spec",
            "rig.yaml",
            "--manifest",
            "m.sqlite",
            "-j",
            "2",
            "--json",
            *words,
        ]
        return cli(*given)

    return run


def statuses(result: Ran) -> dict[str, str]:
    told = [json.loads(line) for line in result.stdout.splitlines()]
    return {line["output"]: line["status"] for line in told}


def alone(samples: Path, name: str) -> dict[str, bytes]:
    """What `rigtri build` makes of a file here."""
    Path("alone").mkdir(exist_ok=True)
    words = ["build", str(samples / name), "--spec", "rig.yaml", "-o", f"alone/{name}", "--overwrite"]
    cli(*words, code=0)
    return {path.name: path.read_bytes() for path in Path("alone").iterdir()}


@pytest.mark.ci
def test_a_bucket_is_worked_through_and_a_second_run_does_nothing(
    batch: Batch, bucket: Any, samples: Path
) -> None:
    inputs = ("s3://studio/in/**/*.gl*", "s3://studio/in/d.usdz")
    done = batch("-O", "s3://studio/out/", inputs=inputs)
    assert done.exit_code == 0, done.stderr
    names = ("a.glb", "d.usdz", "deep er/b#1.glb", "sub/biped.gltf")
    assert statuses(done) == {f"s3://studio/out/{name}": "ok" for name in names}
    want = alone(samples, "biped.glb") | alone(samples, "biped.gltf")
    want |= alone(samples, "biped.usdz")
    found = {key: bucket.cat_file(key) for key in bucket.find("studio/out")}
    assert found.pop("studio/out/a.glb") == found.pop("studio/out/deep er/b#1.glb") == want["biped.glb"]
    assert found.pop("studio/out/d.usdz") == want["biped.usdz"]
    assert found.pop("studio/out/sub/biped.gltf") == want["biped.gltf"]
    assert found.pop("studio/out/sub/biped.bin") == want["biped.bin"]
    assert all(".rigtri-" in key for key in found)
    again = batch("-O", "s3://studio/out/", inputs=inputs)
    assert set(statuses(again).values()) == {"skipped"}
    bucket.put_file(str(samples / "tail.glb"), "studio/in/a.glb")
    bucket.rm("studio/out/sub/biped.bin")
    some = statuses(batch("-O", "s3://studio/out/", inputs=inputs))
    assert {name for name, status in some.items() if status == "ok"} == {
        "s3://studio/out/a.glb",
        "s3://studio/out/sub/biped.gltf",
    }
    assert bucket.exists("studio/out/sub/biped.bin")


@pytest.mark.ci
def test_what_is_wrong_with_files_that_were_fetched_is_reported_where_they_are(
    batch: Batch, bucket: Any, samples: Path
) -> None:
    for name in ("x", "y"):
        bucket.pipe_file(f"studio/in/cut/{name}.glb", (samples / "biped.glb").read_bytes()[:900])
    done = batch("-O", "s3://studio/out/", "--log", "log.jsonl", inputs=("s3://studio/in/cut/*.glb",))
    assert done.exit_code in (3, 7)
    told = [json.loads(line)["message"] for line in Path("log.jsonl").read_text().splitlines()]
    assert [text.split(": ")[0] for text in sorted(told)] == [f"s3://studio/in/cut/{k}.glb" for k in "xy"]


@pytest.mark.slow
def test_outputs_of_others_are_not_replaced(batch: Batch, bucket: Any) -> None:
    bucket.pipe_file("studio/out/a.glb", b"theirs")
    lost = batch("-O", "s3://studio/out")
    assert lost.exit_code == 2
    assert "s3://studio/out/a.glb" in lost.stdout
    bucket.rm("studio/out/a.glb")
    bucket.pipe_file("studio/out/sub/biped.bin", b"theirs")
    done = batch("-O", "s3://studio/out")
    assert done.exit_code == 7
    assert "s3://studio/out/sub/biped.bin exists and is another file" in done.stderr
    assert bucket.cat_file("studio/out/sub/biped.bin") == b"theirs"
    assert not bucket.exists("studio/out/sub/biped.gltf")
    assert statuses(batch("-O", "s3://studio/out", "--overwrite"))["s3://studio/out/sub/biped.gltf"] == "ok"


KILLED = """
import os, signal, sys
from rigtri.pipeline.batch import urls
from rigtri.cli.main import program
put = urls.put
urls.put = lambda place, url: (put(place, url), url.endswith(".glb") and os.kill(os.getpid(), signal.SIGKILL))
program(sys.argv[1:])
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
def test_a_killed_run_is_found_done_by_what_it_has_sent(batch: Batch, bucket: Any) -> None:
    one = ("s3://studio/in/a.glb",)
    words = ["batch", *one, "--spec", "rig.yaml", "--manifest", "m.sqlite", "-O", "s3://studio/out"]
    killed = subprocess.run([sys.executable, "-c", KILLED, *words], capture_output=True, check=False)
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    before = bucket.info("studio/out/a.glb")["LastModified"]
    assert statuses(batch("-O", "s3://studio/out", inputs=one)) == {"s3://studio/out/a.glb": "ok"}
    assert bucket.info("studio/out/a.glb")["LastModified"] == before
    assert statuses(batch("-O", "s3://studio/out", inputs=one)) == {"s3://studio/out/a.glb": "skipped"}


def test_files_come_from_the_web_and_secrets_stay_out_of_everything(
    batch: Batch, samples: Path, tmp_path: Path
) -> None:
    (tmp_path / "web").mkdir()
    for name in ("biped.gltf", "biped.bin"):
        shutil.copy(samples / name, tmp_path / "web")

    class Quiet(SimpleHTTPRequestHandler):
        def __init__(self, *words: Any) -> None:
            super().__init__(*words, directory=str(tmp_path / "web"))

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Quiet) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        host = f"127.0.0.1:{server.server_port}"
        Path("list.txt").write_text(f"http://me:s3cret@{host}/biped.gltf?token=t0ken\n")
        done = batch("-O", "out", "--log", "log.jsonl", inputs=("@list.txt",))
        assert done.exit_code == 0, done.stderr
        assert statuses(done) == {"out/biped.gltf": "ok"}
        gone = batch("-O", "out", inputs=(f"http://me:s3cret@{host}/none.glb?token=t0ken",))
        assert gone.exit_code == 3
        assert f"There is no file http://{host}/none.glb" in gone.stdout
        server.shutdown()
    kept = b"".join(
        path.read_bytes() for path in tmp_path.glob("*") if path.is_file() and path.name != "list.txt"
    )
    said = (done.stdout + done.stderr + gone.stdout + gone.stderr).encode()
    for secret in (b"s3cret", b"t0ken"):
        assert secret not in kept + said
    assert (tmp_path / "out/biped.bin").exists()


@pytest.mark.slow
def test_what_a_file_refers_to_elsewhere_is_not_fetched(
    batch: Batch, bucket: Any, samples: Path, tmp_path: Path
) -> None:
    text = json.loads((samples / "biped.gltf").read_text())
    for number, uri in enumerate(
        ("s3://studio/in/sub/biped.bin", "../sub/biped.bin", str(samples / "biped.bin"))
    ):
        text["buffers"][0]["uri"] = uri
        bucket.pipe_file(f"studio/bad/{number}.gltf", json.dumps(text).encode())
    done = batch("-O", "s3://studio/out", inputs=("s3://studio/bad/*.gltf",))
    assert set(statuses(done).values()) == {"error"}
    assert "fetches nothing from" in done.stderr
    told = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert sum("lies outside the folder of the file" in line for line in told) == 2
    assert str(tmp_path.parent.parent) not in done.stderr.replace(str(samples), "")
    assert not bucket.exists("studio/out")


def test_a_store_that_keeps_no_hashes_works_too(batch: Batch, samples: Path, tmp_path: Path) -> None:
    place = tmp_path / "store"
    (place / "in/x").mkdir(parents=True)
    shutil.copy(samples / "biped.glb", place / "in/x/a.glb")
    words = ("-O", f"file://{place}/out", "--base", f"file://{place}/in")
    for status in ("ok", "skipped"):
        done = batch(*words, inputs=(f"file://{place}/in/x/a.glb",))
        assert set(statuses(done).values()) == {status}, done.stderr
    assert [path.name for path in (place / "out/x").iterdir()] == ["a.glb"]


@pytest.mark.ci
@pytest.mark.parametrize(
    ("words", "said"),
    [
        slow(("-O", "s3://studio/out", "--resources", "relink"), "cannot refer to files of a remote store"),
        (("-O", "http://127.0.0.1/out"), "nothing can be written there"),
        slow(("-O", "memory://out"), "what is written there is gone when the batch ends"),
    ],
)
def test_what_cannot_be_is_reported_before_anything_is_done(
    batch: Batch, bucket: Any, words: tuple[str, ...], said: str
) -> None:
    done = batch(*words)
    assert done.exit_code == 2
    assert said in done.stdout


@pytest.mark.ci
def test_without_a_manifest_here_or_the_extra_it_reports_what_to_do(
    batch: Batch, bucket: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["batch", "s3://studio/in/a.glb", "--spec", "rig.yaml", "-O", "s3://studio/out"]
    told = cli(*words)
    assert (told.exit_code, "--manifest FILE.sqlite" in told.stderr) == (2, True)
    monkeypatch.setitem(sys.modules, "fsspec", None)
    told = cli(*words)
    assert (told.exit_code, 'pip install "rigtri[remote]"' in told.stderr) == (2, True)


@pytest.mark.slow
def test_a_store_that_takes_nothing_is_reported_once_before_any_work(batch: Batch, bucket: Any) -> None:
    told = batch("-O", "s3://nobucket/out")
    assert told.exit_code == 3
    assert json.loads(told.stdout)["error"]["message"] == (
        "nothing can be written to s3://nobucket/out: there is no s3://nobucket; make it, or give another -O"
    )
    assert batch("-O", "s3://studio/out", "--dry-run").exit_code == 0
    assert not bucket.exists("studio/out"), "what was tried with is still there"


@pytest.mark.ci
@pytest.mark.parametrize("pattern", ["s3://nobucket/*.glb", slow("s3://nobucket/in/**/*.*l*")])
def test_a_bucket_that_is_not_there_is_named(batch: Batch, bucket: Any, pattern: str) -> None:
    told = batch("-O", "out", inputs=(pattern,))
    assert told.exit_code == 2
    assert f"'{pattern}' matches no file; there is no s3://nobucket" in told.stdout

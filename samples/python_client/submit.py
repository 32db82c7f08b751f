#!/usr/bin/env python3
"""Bakes a scene on a lightwelld, from Python: upload, submit, watch, download.

Usage: submit.py SCENE.glb OUT.lwc [--server HOST:PORT] [--token-file FILE] [--settings JSON]

Needs python3-grpcio and python3-protobuf. The message classes are made from the service's own .proto with protoc and Debian's
grpc_python_plugin (protobuf-compiler-grpc) when the program starts; a real client would do that in its build.
"""
import argparse
import hashlib
import pathlib
import subprocess
import sys
import tempfile
import time
import uuid

import grpc

SCHEMAS = pathlib.Path(__file__).resolve().parents[2] / "schemas"
PIECE_BYTES = 1 << 20


def load_service():
    """The generated modules service_pb2 and service_pb2_grpc."""
    folder = tempfile.TemporaryDirectory()
    plugin = subprocess.run(["which", "grpc_python_plugin"], capture_output=True, text=True, check=True).stdout.strip()
    subprocess.run(["protoc", f"--proto_path={SCHEMAS}", f"--python_out={folder.name}", f"--grpc_out={folder.name}",
                    f"--plugin=protoc-gen-grpc={plugin}", "lightwell/v1/service.proto"], check=True)
    sys.path.insert(0, folder.name)
    from lightwell.v1 import service_pb2, service_pb2_grpc
    folder.cleanup()
    return service_pb2, service_pb2_grpc


def pieces(pb, data, sha256, offset):
    """An upload from `offset` on. The first message names the content."""
    first = True
    for at in range(offset, max(len(data), offset + 1), PIECE_BYTES):
        message = pb.UploadRequest(data=data[at:at + PIECE_BYTES])
        if first:
            message.sha256, message.size, message.offset = sha256, len(data), offset
            first = False
        yield message


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--server", default="127.0.0.1:7411")
    parser.add_argument("--token-file", type=pathlib.Path)
    parser.add_argument("--settings", default="{}", help="as `settings` of `lightwell bake --json`; missing keys have their defaults")
    arguments = parser.parse_args()

    pb, pb_grpc = load_service()
    service = pb_grpc.BakeServiceStub(grpc.insecure_channel(arguments.server))
    metadata = []
    if arguments.token_file:
        metadata.append(("authorization", "Bearer " + arguments.token_file.read_text().split()[-1]))

    data = arguments.scene.read_bytes()
    sha256 = hashlib.sha256(data).hexdigest()
    while True:
        known = service.FindUploads(pb.FindUploadsRequest(sha256=[sha256]), metadata=metadata).uploads[0]
        if known.complete:
            break
        service.Upload(pieces(pb, data, sha256, known.received_bytes), metadata=metadata)

    spec = pb.JobSpec(scene=arguments.scene.name, settings_json=arguments.settings, label="from Python",
                      files=[pb.SceneFile(name=arguments.scene.name, sha256=sha256, size=len(data))])
    job = service.SubmitJob(pb.SubmitJobRequest(spec=spec, idempotency_key=str(uuid.uuid4())), metadata=metadata)
    print("job", job.id)

    while job.state in (pb.JOB_STATE_QUEUED, pb.JOB_STATE_RUNNING):
        try:
            for job in service.WatchJob(pb.WatchJobRequest(id=job.id), metadata=metadata):
                progress = job.progress
                print(f"{100 * progress.fraction:3.0f} %  {progress.phase}, {progress.tasks_done} of {progress.tasks_total} tasks "
                      f"({progress.tasks_reused} reused)")
        except grpc.RpcError as error:
            if error.code() != grpc.StatusCode.UNAVAILABLE:
                raise
            time.sleep(1)  # the server restarts; the job is safe
    if job.state != pb.JOB_STATE_SUCCEEDED:
        sys.exit(f"{pb.JobState.Name(job.state)}: {job.error.id}: {job.error.message}")

    with open(arguments.output, "wb") as output:
        for piece in service.DownloadResult(pb.DownloadResultRequest(id=job.id), metadata=metadata):
            output.write(piece.data)
    print(f"{arguments.output}: {job.result.size} bytes")


if __name__ == "__main__":
    try:
        main()
    except grpc.RpcError as error:
        detail = dict(error.trailing_metadata() or ()).get("lightwell-error-id", "")
        sys.exit(f"{error.code().name} {detail}: {error.details()}")

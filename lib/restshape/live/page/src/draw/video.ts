// The canvas as a video file, from one press of a button to the next.

import { download } from "./picture";

const RATE = 60; // frames a second at most
const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

export class Video {
  readonly possible: boolean;
  private recorder: MediaRecorder | null = null;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.possible = typeof MediaRecorder === "function" && "captureStream" in canvas;
  }

  /** Begins, or ends and hands the file to the browser. Gives whether it records now. */
  toggle(name: string): boolean {
    if (this.recorder) {
      this.recorder.stop();
      this.recorder = null;
      return false;
    }
    const mimeType = KINDS.find((kind) => MediaRecorder.isTypeSupported(kind));
    const recorder = new MediaRecorder(this.canvas.captureStream(RATE), mimeType ? { mimeType } : {});
    const pieces: Blob[] = [];
    recorder.ondataavailable = ({ data }) => { if (data.size) pieces.push(data); };
    recorder.onstop = () => {
      const type = recorder.mimeType;
      for (const track of recorder.stream.getTracks()) track.stop();
      download(new Blob(pieces, { type }), `${name}.${type.includes("mp4") ? "mp4" : "webm"}`);
    };
    recorder.start(1_000);
    this.recorder = recorder;
    return true;
  }
}

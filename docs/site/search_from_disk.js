// Browsers give pages that are read from disk neither files to fetch nor workers: the index comes as a script (INDEX is put in by build.py),
// and the theme's worker runs in a frame. The theme looks for both names.
if (location.protocol === "file:") {
  window.__search = { index: Promise.resolve(INDEX) };
  window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.inside = frame.contentWindow;
      this.inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      const load = (src) =>
        new Promise((done, failed) => {
          const script = this.inside.document.createElement("script");
          script.src = src;
          script.onload = done;
          script.onerror = failed;
          this.inside.document.body.append(script);
        });
      this.inside.importScripts = async (...urls) => {
        for (const one of urls) await load(one);
      };
      this.ready = load(new URL(url, location.href).href);
    }
    postMessage(data) {
      this.ready.then(() => this.inside.dispatchEvent(new this.inside.MessageEvent("message", { data })));
    }
  };
  window.Worker = window.IFrameWorker;
}

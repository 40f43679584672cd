// What the page carries: facts as JSON, and files as base64, each in an element of its own.

/** The facts that rigtri has written about the files; rigtri/export/viewer/page_data.py says what is in them. */
export function facts() {
  return JSON.parse(document.getElementById('facts').textContent);
}

/** The bytes of the file in the element with an id. */
export function bytesOf(id) {
  const text = atob(document.getElementById(id).textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}

/** The address of what rigtri has told is lacking. */
export const LACKING = 'data:,';

/** The files that a glTF names, as addresses inside the page; nothing is asked of a network. */
export class Files {
  constructor(listed) {
    this.listed = new Map(listed.map((file) => [file.name, file.id]));
    this.made = new Map();
  }

  /** Where a loader finds what a URI names; what is lacking has an address with nothing there. */
  address(uri) {
    if (/^(data|blob):/i.test(uri)) return uri;
    if (!this.listed.has(uri)) return LACKING;
    if (!this.made.has(uri)) {
      this.made.set(uri, URL.createObjectURL(new Blob([bytesOf(this.listed.get(uri))])));
    }
    return this.made.get(uri);
  }

  /** What to call the image at an address. */
  named(address) {
    for (const [uri, made] of this.made) if (made === address) return `the image ${uri}`;
    return 'an image that is in the file';
  }
}

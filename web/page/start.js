// Starts the page: unpacks three.js, whose modules are one file compressed by gzip since plain servers compress
// nothing, and gives them the names by which page.js imports them. No module may be loaded before the import map, so
// this is a plain script.
(async () => {
  const isGzip = (bytes) => bytes[0] === 0x1f && bytes[1] === 0x8b; // some servers unpack what they send

  async function loadModules(url) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    const bytes = new Uint8Array(await response.arrayBuffer());
    const plain = isGzip(bytes) ? new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')) : bytes;
    return new Response(plain).json();
  }

  function addScript(type, properties) {
    document.head.append(Object.assign(document.createElement('script'), { type, ...properties }));
  }

  if (location.protocol === 'file:') return; // the page says that it needs a server
  try {
    const modules = Object.entries(await loadModules('three.json.gz'));
    const addressOf = (text) => URL.createObjectURL(new Blob([text], { type: 'text/javascript' }));
    const imports = Object.fromEntries(modules.map(([name, text]) => [name, addressOf(text)]));
    addScript('importmap', { textContent: JSON.stringify({ imports: { ...imports, octalux: './index.js' } }) });
    addScript('module', { src: 'page.js' });
  } catch (error) {
    document.getElementById('progress').hidden = true;
    document.getElementById('stage').textContent = `This room cannot be shown: ${error.message}`;
    throw error;
  }
})();

// Reads figures off under the pointer or by the arrow keys; a double click or Enter enlarges one, Escape ends that.
(function () {
  'use strict';
  var reader = document.createElement('output');
  reader.className = 'reader';
  reader.hidden = true;
  document.body.appendChild(reader);
  function range(svg, name) { return svg.getAttribute(name).split(' ').map(Number); }
  function short(v, r) {
    var step = Math.abs(r[1] - r[0]) / 500;
    var small = 1e-4 > step;
    if (small || Math.abs(v) >= 1e6) { return v.toExponential(3); }
    return v.toFixed(Math.max(0, Math.min(6, Math.ceil(-Math.log10(step)))));
  }
  // Corners of a line, `null` where it is broken; none if it runs back, as a portrait does.
  function corners(path) {
    var at = [0, 0];
    var all = [];
    var forward = true;
    var steps = path.getAttribute('d').matchAll(/([Ml])(-?\d+) ?(-?\d+)/g);
    for (var step of steps) {
      var to = [Number(step[2]), Number(step[3])];
      if (step[1] === 'M') { all.push(null); } else { to = [at[0] + to[0], at[1] + to[1]]; }
      forward = forward && to[0] >= at[0];
      all.push(to);
      at = to;
    }
    return forward ? all : [];
  }
  // Where a line is at a place across, if it is there; of dots the nearest.
  function height(path, x) {
    path.corners = path.corners || corners(path);
    var reach = path.classList.contains('dots') ? 20 : 0;
    for (var i = 1; path.corners.length > i; i += 1) {
      var a = path.corners[i - 1];
      var b = path.corners[i];
      if (b && reach && reach >= Math.abs(b[0] - x)) { return b[1]; }
      if (a && b && x >= a[0] && b[0] >= x) {
        return b[0] > a[0] ? a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) : b[1];
      }
    }
    return null;
  }
  function values(svg, fx, ry) {
    var box = svg.viewBox.baseVal;
    var found = [];
    ['measured', 'simulated', 'residual', 'input'].forEach(function (name) {
      svg.querySelectorAll('path.' + name + ':not(.filled)').forEach(function (path) {
        var y = height(path, fx * box.width);
        if (y !== null) { found.push(name + ' ' + short(ry[1] - y / box.height * (ry[1] - ry[0]), ry)); }
      });
    });
    return found.join(', ');
  }
  function show(svg, fx, fy, x, y) {
    var rx = range(svg, 'data-x');
    var ry = range(svg, 'data-y');
    var text = short(rx[0] + fx * (rx[1] - rx[0]), rx);
    var lines = values(svg, fx, ry);
    if (lines) { text += ': ' + lines; }
    else if (fy !== null) { text += ', ' + short(ry[1] - fy * (ry[1] - ry[0]), ry); }
    reader.textContent = text;
    reader.hidden = false;
    reader.style.left = Math.min(x + 12, window.innerWidth - reader.offsetWidth - 4) + 'px';
    reader.style.top = Math.max(2, y - 28) + 'px';
  }
  function large(figure) {
    var was = figure.classList.contains('large');
    document.querySelectorAll('figure.large').forEach(function (f) { f.classList.remove('large'); });
    if (!was) { figure.classList.add('large'); }
  }
  document.querySelectorAll('svg[data-x]').forEach(function (svg) {
    var at = 0.5;
    var figure = svg.closest('figure');
    svg.setAttribute('tabindex', '0');
    svg.addEventListener('pointermove', function (e) {
      var box = svg.getBoundingClientRect();
      show(svg, (e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height, e.clientX, e.clientY);
    });
    svg.addEventListener('pointerleave', function () { reader.hidden = true; });
    svg.addEventListener('blur', function () { reader.hidden = true; });
    svg.addEventListener('dblclick', function () { if (figure) { large(figure); } });
    svg.addEventListener('keydown', function (e) {
      var step = { ArrowLeft: -0.01, ArrowRight: 0.01 }[e.key];
      if (step) {
        at = Math.max(0, Math.min(1, at + step));
        var box = svg.getBoundingClientRect();
        show(svg, at, null, box.left + at * box.width, box.top);
        e.preventDefault();
      }
      if (e.key === 'Enter') { if (figure) { large(figure); } }
    });
  });
  document.addEventListener('keydown', function (e) {
    if (e.key === 'Escape') {
      document.querySelectorAll('figure.large').forEach(function (f) { f.classList.remove('large'); });
    }
  });
}());
